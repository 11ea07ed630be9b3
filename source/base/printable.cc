#include <slipstick/base/printable.h>

#include <algorithm>
#include <cctype>
#include <cstdio>
#include <sstream>

namespace slipstick
{
  namespace
  {
    constexpr std::size_t longest_value = 80, longest_line = 2000; // characters

    /// Number of bytes of the UTF-8 character at @p k, 0 if it is invalid.
    unsigned int length_at(const std::string &text, const std::size_t k)
    {
      const auto byte = [&](const std::size_t i) {
        return i < text.size() ? static_cast<unsigned char>(text[i]) : static_cast<unsigned char>(0);
      };
      const unsigned char first = byte(k);
      if (first < 0x80)
        return 1;
      const unsigned int n = first >= 0xC2 && first < 0xE0   ? 2
                             : first >= 0xE0 && first < 0xF0 ? 3
                             : first >= 0xF0 && first < 0xF5 ? 4
                                                             : 0;
      for (unsigned int i = 1; i < n; ++i)
        if ((byte(k + i) & 0xC0) != 0x80)
          return 0;
      const unsigned char second = byte(k + 1); // rejects overlong forms, surrogates, code points above the last plane
      if ((first == 0xE0 && second < 0xA0) || (first == 0xED && second > 0x9F) || (first == 0xF0 && second < 0x90) ||
          (first == 0xF4 && second > 0x8F))
        return 0;
      return n;
    }
  } // namespace

  std::size_t first_invalid_utf8(const std::string &text)
  {
    for (std::size_t k = 0; k < text.size();)
      {
        const unsigned int n = length_at(text, k);
        if (n == 0)
          return k;
        k += n;
      }
    return std::string::npos;
  }

  std::string printable(const std::string &text)
  {
    std::string result;
    for (std::size_t k = 0; k < text.size();)
      {
        const unsigned int  n = length_at(text, k);
        const unsigned char c = text[k];
        const bool          is_control =
          c < 0x20 || c == 0x7F || (c == 0xC2 && n == 2 && static_cast<unsigned char>(text[k + 1]) < 0xA0);
        if (c == '\n' || c == '\t')
          result += c == '\t' ? ' ' : '\n';
        else if (n > 0 && !is_control)
          result += text.substr(k, n);
        else
          for (unsigned int i = 0; i < std::max(n, 1u); ++i)
            {
              char escaped[5];
              std::snprintf(escaped, sizeof(escaped), "\\x%02X", static_cast<unsigned char>(text[k + i]));
              result += escaped;
            }
        k += std::max(n, 1u);
      }
    return result;
  }

  std::string shortened(const std::string &text, const std::size_t most)
  {
    if (text.size() <= most)
      return text;
    const auto  continues = [&](const std::size_t k) { return (static_cast<unsigned char>(text[k]) & 0xC0) == 0x80; };
    std::size_t head = most * 3 / 4, tail = text.size() - (most - head);
    while (head > 0 && continues(head))
      --head;
    while (tail < text.size() && continues(tail))
      ++tail;
    return text.substr(0, head) + "..." + text.substr(tail);
  }

  std::string for_terminal(const std::string &message)
  {
    const std::string  text = printable(message);
    std::istringstream lines(text);
    std::string        line, result;
    while (std::getline(lines, line))
      {
        // a value starts at a quotation mark not preceded by a letter and ends at one not followed by a letter
        const auto is_letter = [&](const std::size_t k) {
          return k < line.size() && std::isalnum(static_cast<unsigned char>(line[k]));
        };
        std::string short_line;
        for (std::size_t k = 0; k < line.size();)
          {
            std::size_t end = std::string::npos;
            if (line[k] == '\'' && (k == 0 || !is_letter(k - 1)))
              for (end = line.find('\'', k + 1); end != std::string::npos && is_letter(end + 1);)
                end = line.find('\'', end + 1);
            if (end == std::string::npos)
              {
                short_line += line[k++];
                continue;
              }
            short_line += '\'' + shortened(line.substr(k + 1, end - k - 1), longest_value) + '\'';
            k = end + 1;
          }
        result += (result.empty() ? "" : "\n") + shortened(short_line, longest_line);
      }
    return result;
  }
} // namespace slipstick
