#include <slipstick/base/exceptions.h>
#include <slipstick/base/text.h>
#include <slipstick/mesh/abaqus_lines.h>

#include <algorithm>
#include <cctype>
#include <cmath>

namespace slipstick::mesh
{
  std::string upper(std::string text)
  {
    std::transform(text.begin(), text.end(), text.begin(), [](const unsigned char c) { return std::toupper(c); });
    return text;
  }

  void AbaqusPlace::fail(const std::string &problem) const
  {
    throw InputError("mesh file " + file + ":" + std::to_string(line) + ": " + problem,
                     "write a flat Abaqus input file of one part with *NODE, *ELEMENT (CPS3, CPE4, C3D8, C3D10, ...), "
                     "*ELSET, *NSET, or use Gmsh's .msh");
  }

  unsigned long long AbaqusPlace::number(const std::string &word) const
  {
    const auto value = parse_number(word);
    if (!value || *value < 0 || *value != std::floor(*value) || *value > 1e15)
      fail("'" + word + "' is not the number of a node or element");
    return static_cast<unsigned long long>(*value);
  }

  AbaqusLines::AbaqusLines(const std::string &file, const std::string &text)
    : lines(text)
    , at{file, 0}
  {
    next();
  }

  AbaqusKeyword AbaqusLines::keyword() const
  {
    const auto    parts = split_list(line);
    AbaqusKeyword key;
    key.name = upper(collapse_blanks(parts[0].substr(1)));
    for (unsigned int k = 1; k < parts.size(); ++k)
      {
        const auto equal = parts[k].find('=');
        key.parameters[upper(trim(parts[k].substr(0, equal)))] =
          equal == std::string::npos ? "" : trim(parts[k].substr(equal + 1));
      }
    return key;
  }

  void AbaqusLines::next()
  {
    do
      {
        is_after_last = !std::getline(lines, line);
        ++at.line;
        line = is_after_last ? "" : trim(line);
    } while (!is_after_last && (line.empty() || line.compare(0, 2, "**") == 0));
  }

  std::vector<std::string> AbaqusLines::words() const
  {
    auto parts = split_list(line);
    while (!parts.empty() && parts.back().empty()) // comma at the end of the line
      parts.pop_back();
    return parts;
  }
} // namespace slipstick::mesh
