// Keyword lines and data lines of an Abaqus input file.
#pragma once

#include <map>
#include <sstream>
#include <string>
#include <vector>

namespace slipstick::mesh
{
  /// In capitals: Abaqus is not case-sensitive.
  std::string upper(std::string text);

  /// A line of the file, for messages.
  struct AbaqusPlace
  {
    std::string  file;
    unsigned int line = 0;

    /// @throws InputError that names file and line.
    [[noreturn]] void fail(const std::string &problem) const;

    /// The number of a node or element. @throws InputError if @p word is none.
    unsigned long long number(const std::string &word) const;
  };

  /// A keyword line: its parameters by name, all names in capitals.
  struct AbaqusKeyword
  {
    std::string                        name;
    std::map<std::string, std::string> parameters;

    bool has(const std::string &parameter) const
    {
      return parameters.count(parameter) > 0;
    }

    /// Empty if the parameter is not given or has no value.
    std::string operator[](const std::string &parameter) const
    {
      const auto found = parameters.find(parameter);
      return found == parameters.end() ? "" : found->second;
    }
  };

  /// Reads @p text, the content of @p file, from its first line; blank lines and comments are skipped.
  class AbaqusLines
  {
  public:
    AbaqusLines(const std::string &file, const std::string &text);

    bool at_end() const
    {
      return is_after_last;
    }

    bool is_keyword() const
    {
      return line[0] == '*';
    }

    /// The current line, which must be a keyword line.
    AbaqusKeyword keyword() const;

    /// Calls f(words) for the data lines up to the next keyword, which becomes the current line.
    template <typename F>
    void for_data(const F &f)
    {
      for (next(); !at_end() && !is_keyword(); next())
        f(words());
    }

    /// The current line.
    const AbaqusPlace &place() const
    {
      return at;
    }

    /// The same as of the current place.
    [[noreturn]] void fail(const std::string &problem) const
    {
      at.fail(problem);
    }
    unsigned long long number(const std::string &word) const
    {
      return at.number(word);
    }

  private:
    void                     next();
    std::vector<std::string> words() const; // of a data line

    std::istringstream lines;
    AbaqusPlace        at;
    std::string        line; // trimmed
    bool               is_after_last = false;
  };
} // namespace slipstick::mesh
