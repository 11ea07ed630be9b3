#include <slipstick/base/exceptions.h>
#include <slipstick/base/text.h>
#include <slipstick/mesh/word_reader.h>

#include <algorithm>
#include <charconv>
#include <cmath>

namespace slipstick::mesh
{
  namespace
  {
    bool is_blank(const char c)
    {
      return c == ' ' || c == '\t' || c == '\r' || c == '\n';
    }
  } // namespace

  WordReader::WordReader(const std::string &file_name, const std::string &content, const std::string &the_remedy)
    : file(file_name)
    , text(content)
    , remedy(the_remedy)
  {}

  void WordReader::fail(const std::string &problem) const
  {
    throw InputError("mesh file " + file + ":" + std::to_string(line_number) + ": " + problem, remedy);
  }

  void WordReader::fail_corrupt() const
  {
    fail("is truncated or corrupt in its section " + section);
  }

  std::string WordReader::word()
  {
    for (; at < text.size() && is_blank(text[at]); ++at)
      line_number += text[at] == '\n';
    const std::size_t start = at;
    while (at < text.size() && !is_blank(text[at]))
      ++at;
    return text.substr(start, at - start);
  }

  std::string WordReader::line()
  {
    const std::size_t start = at, end = std::min(text.find('\n', at), text.size());
    at = std::min(end + 1, text.size());
    ++line_number;
    return trim(text.substr(start, end - start));
  }

  bool WordReader::at_end() const
  {
    return at >= text.size();
  }

  long long WordReader::integer()
  {
    const std::string digits = word();
    long long         value  = 0;
    const auto        result = std::from_chars(digits.data(), digits.data() + digits.size(), value);
    if (digits.empty() || result.ec != std::errc() || result.ptr != digits.data() + digits.size())
      fail_corrupt();
    return value;
  }

  double WordReader::real()
  {
    std::string digits = word();
    std::replace(digits.begin(), digits.end(), 'D', 'e');
    std::replace(digits.begin(), digits.end(), 'd', 'e');
    const auto value = parse_number(digits);
    if (!value || !std::isfinite(*value))
      fail_corrupt();
    return *value;
  }

  std::size_t WordReader::count(const std::size_t least)
  {
    const long long n = integer();
    if (n < 0 || static_cast<std::size_t>(n) > (text.size() - at) / least)
      fail_corrupt();
    return n;
  }

  bool WordReader::skip(const std::string &expected)
  {
    const std::size_t start = at, start_line = line_number;
    if (word() == expected)
      return true;
    at          = start;
    line_number = start_line;
    return false;
  }
} // namespace slipstick::mesh
