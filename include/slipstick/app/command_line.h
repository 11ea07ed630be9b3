// The command line of the program slipstick.
#pragma once

#include <slipstick/scene/list_format.h>

#include <optional>
#include <string>
#include <vector>

namespace slipstick::app
{
  /// The requests of the user. If `message`, `list_parameters` or `new_scene` is set, the case file may be missing.
  struct CommandLine
  {
    std::string                      case_file;
    std::vector<std::string>         overrides;        // "Section/Sub/Name=value"
    std::string                      output_directory; // default: output/<name of the case>
    bool                             check  = false;
    bool                             force  = false;
    bool                             resume = false;
    std::string                      picture; // file for a picture of the scene, with `check`; empty: none
    bool                             quiet   = false;
    bool                             verbose = false;
    std::optional<scene::ListFormat> list_parameters;
    std::optional<std::string>       new_scene; // name of the scene to write
    std::optional<std::string>       message;   // text of --help or --version: print it and exit with 0
  };

  /// Prints nothing, never exits and does not use MPI.
  /// @throws InputError for an unknown or incomplete option (suggesting the nearest), for a missing case file, and for
  /// an override without '='.
  CommandLine parse_command_line(int argc, const char *const *argv);
} // namespace slipstick::app
