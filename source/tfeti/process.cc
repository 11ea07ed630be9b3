#include <slipstick/tfeti/process.h>

#include <deal.II/base/mpi.h>

#include <Tpetra_Core.hpp>

#include <cstdlib>
#include <dlfcn.h>
#include <string>

// Defined if the BLAS is OpenBLAS.
extern "C" void openblas_set_num_threads(int) __attribute__((weak));
// Defined if CHOLMOD is built with OpenMP; its parallel regions request four threads regardless of OMP_NUM_THREADS.
extern "C" void omp_set_max_active_levels(int) __attribute__((weak));

namespace
{
  bool opens_regions = false;
}

// Replaces the function of libgomp. CHOLMOD opens thousands of parallel regions per factorisation; each ends in a
// system call, even with one thread, which takes a seventh of the time for factors of 5000 unknowns (perf). Here a
// region is a plain call.
extern "C" void GOMP_parallel(void (*body)(void *), void *data, unsigned int n_threads, unsigned int flags)
{
  using Parallel             = void (*)(void (*)(void *), void *, unsigned int, unsigned int);
  static const auto original = reinterpret_cast<Parallel>(dlsym(RTLD_NEXT, "GOMP_parallel"));
  if (opens_regions && original)
    original(body, data, n_threads, flags);
  else
    body(data);
}

namespace slipstick::tfeti
{
  namespace
  {
    void use_threads(const unsigned int n)
    {
      if (openblas_set_num_threads)
        openblas_set_num_threads(static_cast<int>(n));
      if (omp_set_max_active_levels && !opens_regions)
        omp_set_max_active_levels(0);
    }

    /// Restricts Open MPI 4 and 5 to the components that the run needs. Settings of the user take precedence; unknown
    /// names are ignored.
    void prepare_open_mpi()
    {
      const auto set  = [](const char *name, const char *value) { setenv(name, value, 0); };
      const auto size = std::getenv("OMPI_COMM_WORLD_SIZE"), on_node = std::getenv("OMPI_COMM_WORLD_LOCAL_SIZE");
      const bool is_alone = !size && !std::getenv("PMI_RANK") && !std::getenv("PMIX_RANK");
      // Without mpirun Open MPI would start a daemon: 0.1 s. It would keep its folders in one that the last process to
      // end removes, even while the next one starts and then fails (one of 80 runs, four at a time).
      set("OMPI_MCA_ess_singleton_isolated", "1");
      if (is_alone)
        set("OMPI_MCA_orte_create_session_dirs", "0");
      // On one node the processes communicate through shared memory. Libraries of other networks are loaded
      // nevertheless, and that of Omni-Path measures the processor's clock for 0.2 s (strace).
      if (is_alone || (size && on_node && std::string(size) == on_node))
        {
          set("OMPI_MCA_pml", "ob1");
          set("OMPI_MCA_btl", is_alone ? "self" : "^ofi,openib,uct,usnic");
          // Open MPI 5 prints an error on every rank if the node's interfaces cannot reach each other
          // (open-mpi/ompi#14079)
          set("OMPI_MCA_btl_tcp_if_include", "lo");
        }
    }
  } // namespace

  struct Process::Libraries
  {
    Libraries()
      : mpi(n_arguments, arguments, 1)
      , tpetra(&n_arguments, &arguments)
    {}

    // Kokkos (below Tpetra) and PETSc (below deal.II) parse options of their own (including --help), and PETSc
    // complains about unknown ones: pass them only a program name.
    char name[10] = "slipstick", *names[2] = {name, nullptr}, **arguments = names;
    int  n_arguments = 1;

    dealii::Utilities::MPI::MPI_InitFinalize mpi;
    Tpetra::ScopeGuard                       tpetra;
  };

  Process::Process(const unsigned int n_threads, const bool opens_regions_)
  {
    opens_regions = opens_regions_;
    use_threads(n_threads);
    prepare_open_mpi();
    libraries = std::make_unique<Libraries>();
  }

  Process::~Process() = default;
} // namespace slipstick::tfeti
