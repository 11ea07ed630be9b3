// Sections and numbers of a Gmsh file, in ASCII or binary.
#pragma once

#include <algorithm>
#include <charconv>
#include <cstring>
#include <string>

namespace slipstick::mesh
{
  /// Reads @p text, the content of @p file, from its start.
  class GmshCursor
  {
  public:
    GmshCursor(const std::string &file, const std::string &text);

    bool        binary = false;
    std::string section; // for messages

    /// @throws InputError that names file and section.
    [[noreturn]] void fail(const std::string &problem, const std::string &remedy) const;

    /// fail() because the file does not have the content that it announces.
    [[noreturn]] void fail_broken() const;

    int integer()
    {
      return binary ? bytes<int>() : word<int>();
    }

    std::size_t count()
    {
      return binary ? bytes<std::size_t>() : word<std::size_t>();
    }

    double real()
    {
      return binary ? bytes<double>() : word<double>();
    }

    /// A number in ASCII, in binary files too.
    template <typename Number>
    Number word()
    {
      at = std::min(text.find_first_not_of(" \t\r\n", at), text.size());
      Number     value{};
      const auto result = std::from_chars(text.data() + at, text.data() + text.size(), value);
      if (result.ec != std::errc())
        fail_broken();
      at = result.ptr - text.data();
      return value;
    }

    /// The number of a physical entity without the sign, which gives its orientation.
    int physical(const int number) const;

    /// A number of items of at least @p least bytes each; fails if the rest of the file is too short for them.
    std::size_t checked(const std::size_t n, const std::size_t least) const;

    /// The rest of the current line.
    std::string line();

    /// A name in quotes.
    std::string quoted();

    /// The name of the next section, empty at the end of the file.
    std::string next_section();

    /// Moves past the end of the current section, which must follow immediately unless the section is skipped.
    void end_section(const bool skip);

  private:
    template <typename Number>
    Number bytes()
    {
      if (text.size() - at < sizeof(Number))
        fail_broken();
      Number value;
      std::memcpy(&value, text.data() + at, sizeof(Number));
      at += sizeof(Number);
      return value;
    }

    const std::string &file;
    const std::string &text;
    std::size_t        at = 0;
  };
} // namespace slipstick::mesh
