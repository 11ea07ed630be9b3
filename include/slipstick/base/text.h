// Small conversions between text and values, independent of the locale.
#pragma once

#include <optional>
#include <string>
#include <vector>

namespace slipstick
{
  /// @p text without blanks at both ends.
  std::string trim(const std::string &text);

  /// @p text trimmed, with every run of blanks reduced to one space, since names may be aligned in a file.
  std::string collapse_blanks(const std::string &text);

  /// The parts of a comma-separated list, trimmed; empty for an empty @p text.
  std::vector<std::string> split_list(const std::string &text, const char separator = ',');

  /// The number given by the whole of @p text, with a decimal point in any locale; infinite on overflow.
  std::optional<double> parse_number(const std::string &text);

  /// @p value in the format %.6g.
  std::string short_text(const double value);

  /// The shortest text that reads back as @p value.
  std::string number_text(const double value);

  /// "(1, 2)" or "(1, 2, 3)", with six digits.
  template <class Point>
  std::string point_text(const Point &x, const unsigned int dim)
  {
    std::string text;
    for (unsigned int d = 0; d < dim; ++d)
      text += (d == 0 ? "(" : ", ") + short_text(x[d]);
    return text + ")";
  }

  /// Positive @p value rounded up to two digits.
  double rounded_up(const double value);
} // namespace slipstick
