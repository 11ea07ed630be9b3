// Words and numbers of an ASCII mesh file, with their line numbers.
#pragma once

#include <string>

namespace slipstick::mesh
{
  /// Reads @p text, the content of @p file, from its start.
  class WordReader
  {
  public:
    /// @param remedy for all faults of the file.
    WordReader(const std::string &file, const std::string &text, const std::string &remedy);

    /// @throws InputError that names file and line.
    [[noreturn]] void fail(const std::string &problem) const;

    /// fail() because the current section does not have the expected content.
    [[noreturn]] void fail_corrupt() const;

    /// The next word, empty at the end of the file.
    std::string word();

    /// The rest of the current line, without its end; then moves to the next.
    std::string line();

    /// Whether there is no further line; blank lines count as lines.
    bool at_end() const;

    /// The next word as a number. @throws InputError if it is not a number.
    long long integer();
    double    real(); // accepts Fortran's exponents (1.0D+00); finite

    /// A number of items of at least @p least characters each; fails if the rest of the file is too short for them.
    std::size_t count(const std::size_t least);

    /// Whether the next word is @p expected, which is skipped in that case.
    bool skip(const std::string &expected);

    std::string section; // for messages

  private:
    const std::string  file;
    const std::string &text;
    const std::string  remedy;
    std::size_t        at          = 0;
    std::size_t        line_number = 1;
  };
} // namespace slipstick::mesh
