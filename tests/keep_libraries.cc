// Builds with AddressSanitizer only: libraries that are unloaded (components of Open MPI) stay, so that leaks in them have
// names in the report, which tests/leaks.supp lists.
extern "C" int dlclose(void *)
{
  return 0;
}
