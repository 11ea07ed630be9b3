// Reads .prm files and --set overrides into a plain list of settings with their places.
#pragma once

#include <string>
#include <vector>

namespace slipstick::scene
{
  /// A parameter that is set, or a subsection that is opened.
  struct Setting
  {
    std::string path; // "Contact circle/Law"; of a subsection: "Contact circle"
    std::string value;
    std::string where; // "prm/box.prm:12" or "--set Contact circle/Law=Tresca"
    bool        is_section  = false;
    bool        is_override = false;
  };

  /// The settings of a .prm file in their order, then those of the overrides "Section/Sub/Name=value". The syntax
  /// is deal.II's: `set Name = value`, `subsection Name` ... `end`, `include FILE` (relative to the including
  /// file), comments from # on, a backslash at the end of a line continues it.
  /// @throws InputError for a file that cannot be read, wrong syntax, and a parameter that one file sets twice.
  std::vector<Setting> read_settings(const std::string &file, const std::vector<std::string> &overrides);
} // namespace slipstick::scene
