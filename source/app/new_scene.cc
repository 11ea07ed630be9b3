#include <slipstick/app/new_scene.h>
#include <slipstick/base/exceptions.h>
#include <slipstick/base/nearest_name.h>

#include <filesystem>
#include <fstream>

namespace slipstick::app
{
  std::vector<std::string> new_scene_names()
  {
    std::vector<std::string> names;
    for (const auto &scene : new_scene_texts())
      names.push_back(scene.first);
    return names;
  }

  std::string write_new_scene(const std::string &name)
  {
    for (const auto &[known, text] : new_scene_texts())
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
