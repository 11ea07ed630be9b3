#include <slipstick/app/command_line.h>
#include <slipstick/app/new_scene.h>
#include <slipstick/base/exceptions.h>
#include <slipstick/base/nearest_name.h>

#include <CLI/CLI.hpp>

#include <filesystem>

namespace slipstick::app
{
  namespace
  {
    const std::string usage = "slipstick CASE.prm [options]; see slipstick --help";

    const std::vector<std::pair<std::string, scene::ListFormat>> list_formats = {{"text", scene::ListFormat::text},
                                                                                 {"prm", scene::ListFormat::prm},
                                                                                 {"json", scene::ListFormat::json},
                                                                                 {"latex", scene::ListFormat::latex}};

    scene::ListFormat read_list_format(const std::string &word)
    {
      std::vector<std::string> words;
      for (const auto &[name, format] : list_formats)
        {
          if (name == word)
            return format;
          words.push_back(name);
        }
      throw InputError("--list-parameters " + word + ": unknown format", suggest_name(word, words));
    }

    /// Arguments not recognised by CLI11: options, or case files after the first.
    InputError unknown_argument(const std::string &argument, const CLI::App &app)
    {
      if (argument.empty() || argument[0] != '-')
        return InputError("'" + argument + "' is a second case file; only one can be given",
                          "give one case file: " + usage);
      std::vector<std::string> names;
      for (const CLI::Option *option : app.get_options())
        for (const std::string &name : option->get_lnames())
          names.push_back("--" + name);
      const std::string name = argument.substr(0, argument.find('='));
      return InputError("there is no option '" + name + "'", suggest_name(name, names));
    }

    void check(const CommandLine &line)
    {
      for (const std::string &text : line.overrides)
        if (text.find('=') == std::string::npos || text.find('=') == 0)
          throw InputError("'--set " + text + "' does not have the form NAME=VALUE",
                           "write: --set 'Section/Sub/Name=value', for example --set 'Solver/Tolerance=1e-6'");
      if (line.quiet && line.verbose)
        throw InputError("--quiet and --verbose cannot be combined", "leave one of them out");
      if (line.resume && line.check)
        throw InputError("--resume cannot be combined with --check or --draw", "leave one of them out");
      if (line.case_file.empty() && !line.list_parameters && !line.new_scene)
        throw InputError("no case file is given", usage);
    }
  } // namespace

  CommandLine parse_command_line(int argc, const char *const *argv)
  {
    CommandLine line;
    std::string list_format;

    CLI::App app("slipstick: frictional contact of elastic bodies by Total FETI.\n"
                 "Runs on its own or under mpirun -n N or srun; results agree for every N.");
    app.name("slipstick");
    app.allow_extras();
    app.set_version_flag("--version", "slipstick " SLIPSTICK_VERSION, "print the version and exit");
    app.add_option("case", line.case_file, "scene to solve, for example prm/box_on_circle.prm")->type_name("CASE.prm");
    app.add_option("--set", line.overrides, "override one parameter of the scene; repeatable")
      ->type_name("Section/Sub/Name=value")
      ->allow_extra_args(false);
    const CLI::Option *output =
      app.add_option("--output", line.output_directory, "output directory, default output/<name of the case>")
        ->type_name("DIR");
    app.add_flag("--force", line.force, "run a scene even if it needs more memory than is free");
    app.add_flag("--resume",
                 line.resume,
                 "continue after the last finished load step of a run in the output directory");
    app
      .add_option("--draw",
                  line.picture,
                  "as --check, and draw the scene with supports, loads and contact into an SVG file")
      ->type_name("FILE.svg");
    app.add_flag("--check", line.check, "build and check the scene without solving it");
    const CLI::Option *list =
      app.add_option("--list-parameters", list_format, "list all parameters as text (default), prm, json or latex")
        ->expected(0, 1)
        ->type_name("FORMAT");
    std::string        new_scene;
    const CLI::Option *start =
      app.add_option("--new", new_scene, "write a commented scene to start from: " + join_names(new_scene_names()))
        ->type_name("NAME");
    app.add_flag("--quiet", line.quiet, "print errors only");
    app.add_flag("--verbose", line.verbose, "also print the boundaries of every body");

    try
      {
        app.parse(argc, argv);
      }
    catch (const CLI::CallForHelp &)
      {
        line.message = app.help();
        return line;
      }
    catch (const CLI::CallForVersion &)
      {
        line.message = app.version() + "\n";
        return line;
      }
    catch (const CLI::ParseError &error)
      {
        throw InputError(error.what(), usage);
      }
    auto remaining = app.remaining();
    if (!remaining.empty() && remaining.front() == "--") // only file names follow
      {
        remaining.erase(remaining.begin());
        if (line.case_file.empty() && !remaining.empty())
          {
            line.case_file = remaining.front();
            remaining.erase(remaining.begin());
          }
        if (!remaining.empty())
          throw InputError("'" + remaining.front() + "' is a second case file; only one can be given",
                           "give one case file: " + usage);
      }
    if (!remaining.empty())
      throw unknown_argument(remaining.front(), app);
    if (list->count() > 0)
      line.list_parameters = read_list_format(list_format.empty() ? "text" : list_format);
    if (start->count() > 0)
      line.new_scene = new_scene;
    line.check = line.check || !line.picture.empty();
    check(line);
    if (output->count() > 0 && line.output_directory.empty())
      throw InputError("--output: the name of the directory is empty",
                       "name a directory, for example --output /tmp/run");
    const std::string name = std::filesystem::path(line.case_file).stem().string();
    if (output->count() == 0 && !line.list_parameters && !line.new_scene &&
        (name.empty() || name == "." || name == ".."))
      throw InputError("no output directory can be named after the case file '" + line.case_file + "'",
                       "give one, for example --output output/case, or rename the case file");
    if (output->count() == 0)
      line.output_directory = (std::filesystem::path("output") / std::filesystem::path(line.case_file).stem()).string();
    return line;
  }
} // namespace slipstick::app
