// libFuzzer's entry to all readers: the first byte of the data chooses the format, the others are the file. Every file is either
// refused with one error and its remedy, or read; anything else, or a report of a sanitizer, ends the run. Built with Clang by
// scripts/fuzz --coverage.
#include "read_mesh.h"

#include <slipstick/scene/prm_file.h>
#include <slipstick/scene/stl_file.h>

#include <array>
#include <cstdint>
#include <cstdlib>
#include <fstream>
#include <iostream>

#include <unistd.h>

namespace
{
  using namespace slipstick;

  constexpr std::array<const char *, 5> mesh_formats{{"a.msh", "a.inp", "a.vtk", "a.unv", "a.ucd"}}; // as in seeds.py

  /// A file of this process with the text.
  std::string file_with(const std::string &text)
  {
    const std::string name = "/tmp/slipstick-parsers-" + std::to_string(getpid());
    std::ofstream(name, std::ios::binary) << text;
    return name;
  }

  void read(const unsigned int format, const std::string &text)
  {
    if (format < mesh_formats.size())
      {
        const auto file = mesh::parse_mesh_file(mesh_formats[format], text);
        if (file.dimension() == 3)
          fuzz::whole_body<3>(file);
        else
          fuzz::whole_body<2>(file);
      }
    else if (format == mesh_formats.size())
      scene::read_stl(file_with(text));
    else
      scene::read_settings(file_with(text), {});
  }
} // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t *data, std::size_t size)
{
  if (size == 0)
    return 0;
  try
    {
      read(data[0] % (mesh_formats.size() + 2), {reinterpret_cast<const char *>(data) + 1, size - 1});
    }
  catch (const InputError &error)
    {
      if (!fuzz::has_remedy(error))
        {
          std::cerr << "no remedy: " << error.what() << std::endl;
          std::abort();
        }
    }
  return 0; // other exceptions are not caught: they end the run
}
