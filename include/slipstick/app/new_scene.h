// slipstick --new NAME: a commented scene to start from.
#pragma once

#include <string>
#include <utility>
#include <vector>

namespace slipstick::app
{
  /// Names and texts, from prm/ (cmake/new_scenes.cmake).
  std::vector<std::pair<std::string, std::string>> new_scene_texts();

  /// Names of the scenes that can be written.
  std::vector<std::string> new_scene_names();

  /// Writes NAME.prm into the working directory. @return what to tell the user.
  /// @throws InputError when there is no such scene, the file exists already, or it cannot be written.
  std::string write_new_scene(const std::string &name);
} // namespace slipstick::app
