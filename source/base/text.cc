#include <slipstick/base/text.h>

#include <array>
#include <charconv>
#include <cmath>
#include <cstdio>
#include <limits>
#include <sstream>

namespace slipstick
{
  namespace
  {
    const std::string blanks = " \t\r\n\f\v";
  }

  std::string trim(const std::string &text)
  {
    const auto first = text.find_first_not_of(blanks);
    return first == std::string::npos ? "" : text.substr(first, text.find_last_not_of(blanks) - first + 1);
  }

  std::string collapse_blanks(const std::string &text)
  {
    std::istringstream words(text);
    std::string        word, result;
    while (words >> word)
      result += (result.empty() ? "" : " ") + word;
    return result;
  }

  std::vector<std::string> split_list(const std::string &text, const char separator)
  {
    std::vector<std::string> parts;
    if (trim(text).empty())
      return parts;
    std::size_t begin = 0;
    for (std::size_t end = text.find(separator); end != std::string::npos; end = text.find(separator, begin))
      {
        parts.push_back(trim(text.substr(begin, end - begin)));
        begin = end + 1;
      }
    parts.push_back(trim(text.substr(begin)));
    return parts;
  }

  std::optional<double> parse_number(const std::string &text)
  {
    std::string digits = trim(text);
    if (digits.size() > 1 && digits[0] == '+' && digits[1] != '-')
      digits.erase(0, 1);
    double      value  = 0;
    const char *end    = digits.data() + digits.size();
    const auto  result = std::from_chars(digits.data(), end, value);
    if (digits.empty() || result.ptr != end || result.ec == std::errc::invalid_argument)
      return {};
    if (result.ec == std::errc::result_out_of_range) // underflow (1e-999) is treated like overflow
      return std::numeric_limits<double>::infinity();
    return value;
  }

  std::string number_text(const double value)
  {
    std::array<char, 32> buffer; // the shortest text of a double has at most 24 characters
    const auto           result = std::to_chars(buffer.data(), buffer.data() + buffer.size(), value);
    return std::string(buffer.data(), result.ptr);
  }

  std::string short_text(const double value)
  {
    std::array<char, 32> text;
    return std::string(text.data(), std::snprintf(text.data(), text.size(), "%.6g", value));
  }

  double rounded_up(const double value)
  {
    const double unit = std::pow(10., std::floor(std::log10(value)) - 1);
    return std::ceil(value / unit) * unit;
  }
} // namespace slipstick
