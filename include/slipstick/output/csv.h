// Formats of numbers and words in text files.
#pragma once

#include <string>

namespace slipstick::output
{
  /// Shortest text that reads back as the same number, independent of the locale; "nan", "inf", "-inf".
  std::string to_text(const double value);

  /// A word as a field of a .csv: quoted when it holds a comma, a quote or a line break (RFC 4180).
  std::string csv_field(const std::string &word);
} // namespace slipstick::output
