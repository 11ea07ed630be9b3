#include <slipstick/base/exceptions.h>
#include <slipstick/base/nearest_name.h>
#include <slipstick/base/printable.h>
#include <slipstick/base/text.h>
#include <slipstick/scene/prm_file.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <map>

namespace slipstick::scene
{
  namespace
  {
    constexpr unsigned int most_levels = 10;  // of nested subsections, and of nested includes
    constexpr unsigned int most_files  = 100; // included in total: nested includes may multiply their number

    const std::string encoding_remedy = "save the file as UTF-8 (iconv -f latin1 -t utf-8), or remove the character";

    /// Names and values are written to files that must be UTF-8.
    void check_encoding(const std::string &text, const std::string &where)
    {
      const auto bad = first_invalid_utf8(text);
      if (bad != std::string::npos)
        throw InputError(where + ": '" + text + "' is not UTF-8, from its byte " + std::to_string(bad + 1) + " on",
                         encoding_remedy);
    }

    /// Splits "set Name = value" into "set" and "Name = value".
    std::pair<std::string, std::string> split_first_word(const std::string &line)
    {
      const auto end = line.find_first_of(" \t");
      return end == std::string::npos ? std::make_pair(line, std::string())
                                      : std::make_pair(line.substr(0, end), trim(line.substr(end)));
    }

    std::ifstream open(const std::string &file, const std::string &included_from)
    {
      namespace fs = std::filesystem;
      std::error_code ignore;
      std::ifstream   stream;
      if (fs::is_regular_file(file, ignore)) // opening a pipe would block
        stream.open(file);
      if (stream.is_open())
        return stream;

      std::vector<std::string> names;
      const fs::path           directory = fs::path(file).has_parent_path() ? fs::path(file).parent_path() : ".";
      for (fs::directory_iterator entry(directory, ignore), end; !ignore && entry != end; entry.increment(ignore))
        if (entry->path().extension() == ".prm")
          names.push_back(entry->path().filename().string());
      std::sort(names.begin(), names.end());
      throw InputError((included_from.empty() ? "" : included_from + ": include ") + "'" + file +
                         "' cannot be read as a scene file",
                       "name an existing .prm file; in " + directory.string() + ": " +
                         suggest_name(fs::path(file).filename().string(), names));
    }

    /// Reads one file and the files it includes.
    class Reader
    {
    public:
      Reader(const std::string    &file,
             const std::string    &included_from,
             const unsigned int    depth,
             unsigned int         &n_files,
             std::vector<Setting> &settings);

    private:
      void read_line(const std::string &line);
      void read_assignment(const std::string &text);
      void enter(const std::string &text);
      void leave(const std::string &text);
      void include(const std::string &text);

      std::string where() const
      {
        return file + ":" + std::to_string(line_number);
      }

      std::string path(const std::string &name) const
      {
        std::string result;
        for (const auto &section : sections)
          result += section.first + "/";
        return result + name;
      }

      std::string                                      file;
      unsigned int                                     depth;
      unsigned int                                    &n_files; // read so far
      std::vector<Setting>                            &settings;
      unsigned int                                     line_number = 0; // start of the current statement
      std::vector<std::pair<std::string, std::string>> sections;        // open ones: name, where
      std::map<std::string, std::string>               places;          // path of a parameter -> where it was set
    };

    Reader::Reader(const std::string    &file_name,
                   const std::string    &included_from,
                   const unsigned int    include_depth,
                   unsigned int         &number_of_files,
                   std::vector<Setting> &all_settings)
      : file(file_name)
      , depth(include_depth)
      , n_files(number_of_files)
      , settings(all_settings)
    {
      std::ifstream stream = open(file, included_from);
      std::string   line, statement;
      unsigned int  n_lines = 0;
      while (std::getline(stream, line))
        {
          if (n_lines == 0 && line.compare(0, 3, "\xEF\xBB\xBF") == 0) // byte order mark
            line.erase(0, 3);
          ++n_lines;
          if (statement.empty())
            line_number = n_lines;
          if (line.find('\0') != std::string::npos)
            throw InputError("'" + file + "' is no text file", "name a .prm file");
          line = trim(line.substr(0, line.find('#')));
          check_encoding(line, where());
          if (!line.empty() && line.back() == '\\')
            {
              statement += line.substr(0, line.size() - 1);
              continue;
            }
          read_line(trim(statement + line));
          statement.clear();
        }
      if (stream.bad())
        throw InputError("'" + file + "' could not be read to its end, only " + std::to_string(n_lines) +
                           " lines of it",
                         "check the disk or the network that it is on");
      read_line(trim(statement));
      if (!sections.empty())
        throw InputError(sections.back().second + ": subsection '" + sections.back().first + "' has no end",
                         "close every subsection with a line 'end'");
    }

    void Reader::read_line(const std::string &line)
    {
      if (line.empty())
        return;
      const auto [word, rest] = split_first_word(line);
      if (word == "set" || word == "SET")
        read_assignment(rest);
      else if (word == "subsection" || word == "SUBSECTION")
        enter(rest);
      else if (word == "end" || word == "END")
        leave(rest);
      else if (word == "include" || word == "INCLUDE")
        include(rest);
      else
        throw InputError(where() + ": '" + line + "' is not a statement",
                         "start a line with one of set, subsection, end, include, #: " +
                           suggest_name(word, {"set", "subsection", "end", "include"}));
    }

    void Reader::read_assignment(const std::string &text)
    {
      const auto        equals = text.find('=');
      const std::string name   = collapse_blanks(text.substr(0, equals));
      if (equals == std::string::npos || name.empty())
        throw InputError(where() + ": 'set " + text + "' sets nothing", "write: set NAME = VALUE");
      const auto [place, is_new] = places.emplace(path(name), where());
      if (!is_new)
        throw InputError(where() + ": " + path(name) + " = '" + trim(text.substr(equals + 1)) +
                           "' is set twice (first: " + place->second + ")",
                         "keep one of the two lines");
      settings.push_back({path(name), trim(text.substr(equals + 1)), where(), false});
    }

    void Reader::enter(const std::string &text)
    {
      const std::string name = collapse_blanks(text);
      if (name.empty() || name.find_first_of("/=") != std::string::npos)
        throw InputError(where() + ": 'subsection " + text + "' is not a valid name of a subsection",
                         "write: subsection NAME, without / and =");
      if (sections.size() >= most_levels)
        throw InputError(where() + ": subsection '" + name + "' is nested more than " + std::to_string(most_levels) +
                           " levels deep",
                         "close every subsection with a line 'end'");
      settings.push_back({path(name), "", where(), true});
      sections.emplace_back(name, where());
    }

    void Reader::leave(const std::string &text)
    {
      if (!text.empty() || sections.empty())
        throw InputError(where() + ": 'end' " +
                           (sections.empty() ? "without an open subsection" : "is followed by '" + text + "'"),
                         "write 'end' alone on its line, once for every subsection");
      sections.pop_back();
    }

    void Reader::include(const std::string &text)
    {
      if (depth == most_levels)
        throw InputError(where() + ": include '" + text + "' is nested more than " + std::to_string(most_levels) +
                           " levels deep",
                         "look for a file that includes itself");
      if (++n_files > most_files)
        throw InputError(where() + ": include '" + text + "' would be file number " + std::to_string(n_files) +
                           " of the scene",
                         "include at most " + std::to_string(most_files) +
                           " files; look for files that include others several times");
      if (!sections.empty())
        throw InputError(where() + ": include '" + text + "' inside subsection '" + sections.back().first + "'",
                         "include files at top level");
      const auto directory = std::filesystem::path(file).parent_path();
      Reader((directory / text).string(), where(), depth + 1, n_files, settings);
    }

    Setting read_override(const std::string &text)
    {
      const std::string where = "--set " + text;
      check_encoding(text, "--set");
      const auto  equals = text.find('=');
      std::string path;
      for (const std::string &part : split_list(text.substr(0, equals), '/'))
        path += (path.empty() ? "" : "/") + collapse_blanks(part);
      if (equals == std::string::npos || path.empty())
        throw InputError("'" + where + "' has no '=' that separates name and value",
                         "write: --set 'Section/Sub/Name=value', for example --set 'Solver/Tolerance=1e-6'");
      if (static_cast<unsigned int>(std::count(path.begin(), path.end(), '/')) > most_levels)
        throw InputError("'" + where + "' is nested more than " + std::to_string(most_levels) + " levels deep",
                         "write: --set 'Section/Sub/Name=value', for example --set 'Solver/Tolerance=1e-6'");
      const std::string value = trim(text.substr(equals + 1));
      if (value.find_first_of("#\n") != std::string::npos || (!value.empty() && value.back() == '\\'))
        throw InputError("'" + where + "': a value cannot contain '#' or a line break, or end with a backslash",
                         "leave these characters out");
      return {path, value, where, false, true};
    }
  } // namespace

  std::vector<Setting> read_settings(const std::string &file, const std::vector<std::string> &overrides)
  {
    std::vector<Setting> settings;
    unsigned int         n_files = 1;
    Reader(file, "", 0, n_files, settings);
    for (const std::string &text : overrides)
      settings.push_back(read_override(text));
    return settings;
  }
} // namespace slipstick::scene
