// slipstick --new NAME: writes a commented scene as a starting point.
#pragma once

#include <string>
#include <utility>
#include <vector>

namespace slipstick::app
{
  /// Names and texts of the scenes, from prm/ (cmake/new_scenes.cmake).
  std::vector<std::pair<std::string, std::string>> new_scene_texts();

  /// Names of the available scenes.
  std::vector<std::string> new_scene_names();

  /// Writes NAME.prm into the working directory. @return a message for the user.
  /// @throws InputError when there is no such scene, the file exists already, or it cannot be written.
  std::string write_new_scene(const std::string &name);
} // namespace slipstick::app
