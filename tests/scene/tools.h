// Scenes in temporary files, and the message of an InputError.
#pragma once

#include <slipstick/base/exceptions.h>
#include <slipstick/scene/read.h>

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>
#include <vector>

namespace slipstick::test
{
  inline std::string prm(const std::string &name)
  {
    return std::string(SLIPSTICK_SOURCE_DIR) + "/prm/" + name + ".prm";
  }

  inline std::string read_text(const std::string &file)
  {
    std::ifstream      stream(file);
    std::ostringstream text;
    text << stream.rdbuf();
    return text.str();
  }

  /// A directory of this process, removed at the end of its scope.
  class TemporaryDirectory
  {
  public:
    TemporaryDirectory()
    {
      std::string name = (std::filesystem::temp_directory_path() / "slipstick_XXXXXX").string();
      if (mkdtemp(name.data()) == nullptr)
        throw std::runtime_error("no temporary directory");
      path = name;
    }

    ~TemporaryDirectory()
    {
      std::filesystem::remove_all(path);
    }

    TemporaryDirectory(const TemporaryDirectory &) = delete;

    std::string write(const std::string &name, const std::string &text) const
    {
      std::ofstream(path / name) << text;
      return (path / name).string();
    }

    std::filesystem::path path;
  };

  /// The text of the InputError that @p run throws; fails the test when it throws none.
  template <typename Run>
  std::string error_of(const Run &run)
  {
    try
      {
        run();
      }
    catch (const InputError &error)
      {
        return error.what();
      }
    ADD_FAILURE() << "no InputError";
    return "";
  }

  inline void expect_parts(const std::string &message, const std::vector<std::string> &parts)
  {
    for (const std::string &part : parts)
      EXPECT_NE(message.find(part), std::string::npos) << "'" << part << "' is missing in: " << message;
  }

  /// @p file with @p overrides must be refused with a message that contains all @p parts.
  inline void expect_refused(const std::string              &file,
                             const std::vector<std::string> &overrides,
                             const std::vector<std::string> &parts)
  {
    expect_parts(error_of([&] { scene::read_scene(file, overrides); }), parts);
  }

  /// prm/box_on_circle.prm with @p overrides.
  inline scene::Scene<2> box(const std::vector<std::string> &overrides)
  {
    return scene::read_scene(prm("box_on_circle"), overrides);
  }

  /// prm/box_on_circle.prm with @p overrides must be refused with a message that contains all @p parts.
  inline void refused(const std::vector<std::string> &overrides, const std::vector<std::string> &parts)
  {
    expect_refused(prm("box_on_circle"), overrides, parts);
  }

  /// prm/box_on_circle.prm with the first @p from replaced by @p to must be refused so.
  inline void expect_box_refused(const std::string &from, const std::string &to, const std::vector<std::string> &parts)
  {
    TemporaryDirectory directory;
    std::string        text  = read_text(prm("box_on_circle"));
    const auto         place = text.find(from, text.find("\nset Title"));
    ASSERT_NE(place, std::string::npos) << from;
    text.replace(place, from.size(), to);
    expect_refused(directory.write("box.prm", text), {}, parts);
  }
} // namespace slipstick::test
