// Small conversions between text and values, independent of the locale.
#pragma once

#include <optional>
#include <string>
#include <vector>

namespace slipstick
{
  /// @p text without blanks at both ends.
  std::string trim(const std::string &text);

  /// @p text trimmed, with every run of blanks within it reduced to one space, since names may be aligned in a file.
  std::string collapse_blanks(const std::string &text);

  /// The parts of a comma-separated list, trimmed; none for an empty @p text.
  std::vector<std::string> split_list(const std::string &text, const char separator = ',');

  /// The number that the whole of @p text spells, with a decimal point in any locale; infinite when it overflows.
  std::optional<double> parse_number(const std::string &text);

  /// The shortest text that reads back as @p value.
  std::string number_text(const double value);

  /// @p value, positive, rounded to two digits, never below it.
  double rounded_up(const double value);
} // namespace slipstick
