#include <slipstick/app/new_scene.h>
#include <slipstick/base/exceptions.h>
#include <slipstick/base/nearest_name.h>

#include <filesystem>
#include <fstream>
#include <utility>

namespace slipstick::app
{
  namespace
  {
    // Their texts, put there by cmake/new_scenes.cmake from prm/.
    const std::vector<std::pair<std::string, std::string>> &scenes()
    {
      static const std::vector<std::pair<std::string, std::string>> list = {
#include "new_scenes.inc"
      };
      return list;
    }
  } // namespace

  std::vector<std::string> new_scene_names()
  {
    std::vector<std::string> names;
    for (const auto &scene : scenes())
      names.push_back(scene.first);
    return names;
  }

  std::string write_new_scene(const std::string &name)
  {
    for (const auto &[known, text] : scenes())
      if (known == name)
        {
          const std::string file = name + ".prm";
          std::error_code   ignore;
          if (std::filesystem::exists(std::filesystem::symlink_status(file, ignore)))
            throw InputError("--new " + name + ": " + file + " exists already",
                             "rename it, or go to another directory");
          std::ofstream out(file);
          out << text << std::flush;
          if (!out)
            throw InputError("--new " + name + ": " + file + " cannot be written here",
                             "go to a directory where files can be written");
          return file + " is written; run it: slipstick " + file + "\n";
        }
    throw InputError("--new " + name + ": there is no such scene to start from", suggest_name(name, new_scene_names()));
  }
} // namespace slipstick::app
