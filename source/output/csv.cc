#include <slipstick/output/csv.h>

#include <array>
#include <charconv>

namespace slipstick::output
{
  std::string to_text(const double value)
  {
    std::array<char, 32> text;
    const auto           end = std::to_chars(text.data(), text.data() + text.size(), value).ptr;
    return std::string(text.data(), end);
  }

  std::string csv_field(const std::string &word)
  {
    if (word.find_first_of(",\"\r\n") == std::string::npos)
      return word;
    std::string quoted = "\"";
    for (const char character : word)
      quoted += character == '"' ? std::string("\"\"") : std::string(1, character);
    return quoted + '"';
  }
} // namespace slipstick::output
