#include <slipstick/base/exceptions.h>
#include <slipstick/base/text.h>
#include <slipstick/scene/declare.h>
#include <slipstick/scene/stl_file.h>

#include <algorithm>
#include <cctype>
#include <cstdint>
#include <cstring>
#include <fstream>
#include <sstream>

namespace slipstick::scene
{
  namespace
  {
    // Far more triangles than needed for facets as fine as contact elements; half a gigabyte with the search tree.
    constexpr std::size_t max_triangles = 2000000;
    // Binary files: a header and a count, then per triangle a normal, three corners and two bytes.
    constexpr std::size_t header = 80, head = header + 4, record = 50, normal_bytes = 12;

    using Corners = std::vector<dealii::Point<3>>;

    InputError damaged(const std::string &file, const std::string &problem)
    {
      return InputError("STL file " + file + " " + problem,
                        "export it again from the program that made it, as ASCII or binary STL");
    }

    void check_count(const std::string &file, const std::size_t n)
    {
      if (n > max_triangles)
        throw InputError("STL file " + file + " has " + std::to_string(n) + " triangles, at most " +
                           std::to_string(max_triangles) + " are allowed",
                         "export it with a coarser tolerance, or remove parts that cannot come into contact");
    }

    double checked(const std::string &file, const double value)
    {
      if (!is_usable(value))
        throw damaged(file, "has a coordinate that is not a finite number");
      return value + 0.; // converts -0 to 0
    }

    /// Little-endian, as specified by the format.
    std::uint32_t bits_at(const std::string &bytes, const std::size_t at)
    {
      std::uint32_t value = 0;
      for (unsigned int k = 0; k < 4; ++k)
        value |= std::uint32_t(static_cast<unsigned char>(bytes[at + k])) << (8 * k);
      return value;
    }

    double float_at(const std::string &bytes, const std::size_t at)
    {
      const std::uint32_t bits  = bits_at(bytes, at);
      float               value = 0;
      std::memcpy(&value, &bits, sizeof value);
      return value;
    }

    Corners read_binary(const std::string &file, const std::string &bytes)
    {
      const std::size_t n = bits_at(bytes, header);
      check_count(file, n);
      Corners corners;
      corners.reserve(3 * n);
      for (std::size_t k = 0; k < 3 * n; ++k)
        {
          const std::size_t at = head + k / 3 * record + normal_bytes * (1 + k % 3);
          corners.emplace_back(checked(file, float_at(bytes, at)),
                               checked(file, float_at(bytes, at + 4)),
                               checked(file, float_at(bytes, at + 8)));
        }
      return corners;
    }

    Corners read_ascii(const std::string &file, const std::string &text)
    {
      Corners            corners;
      std::size_t        number = 0, on_facet = 3;
      std::istringstream lines(text);
      const auto         fail = [&](const std::string &problem) {
        return damaged(file, "line " + std::to_string(number) + ": " + problem);
      };
      for (std::string line; std::getline(lines, line);)
        {
          ++number;
          std::istringstream words(line);
          std::string        word;
          words >> word;
          std::transform(word.begin(), word.end(), word.begin(), [](const unsigned char c) { return std::tolower(c); });
          if (word == "facet" || word == "endfacet")
            {
              if (on_facet != 3)
                throw fail("a facet with " + std::to_string(on_facet) + " corners, it must have three");
              on_facet = word == "facet" ? 0 : 3;
            }
          else if (word == "vertex")
            {
              std::array<double, 3> x{};
              for (double &coordinate : x)
                {
                  std::string digits;
                  words >> digits;
                  const auto value = parse_number(digits);
                  if (!value)
                    throw fail("a vertex needs three numbers");
                  coordinate = checked(file, *value);
                }
              if (++on_facet > 3)
                throw fail("a facet with more than three corners");
              corners.emplace_back(x[0], x[1], x[2]);
            }
          else if (!word.empty() && word != "solid" && word != "endsolid" && word != "outer" && word != "endloop")
            throw fail("'" + word.substr(0, 20) + "' is no word of an STL file");
        }
      if (on_facet != 3)
        throw fail("ends within a facet");
      check_count(file, corners.size() / 3);
      return corners;
    }
  } // namespace

  Corners read_stl(const std::string &file)
  {
    std::ifstream      in(file, std::ios::binary);
    std::ostringstream content;
    content << in.rdbuf();
    if (!in)
      throw InputError("STL file " + file + " cannot be read, or is empty", "check its path and permissions");
    const std::string text = content.str();
    // detected by the size, since some programs also begin binary files with "solid"
    if (text.size() >= head && (text.size() - head) % record == 0 &&
        (text.size() - head) / record == bits_at(text, header))
      return read_binary(file, text);
    if (trim(text.substr(0, header)).compare(0, 5, "solid") == 0 && text.find('\0') == std::string::npos)
      return read_ascii(file, text);
    if (text.size() < head)
      throw damaged(file, "is no STL file: it neither begins with 'solid' nor has a binary header");
    throw damaged(
      file,
      "is no STL file, or is truncated: it does not begin with 'solid', and as a binary file it would have " +
        std::to_string(bits_at(text, header)) + " triangles, which do not fit its " + std::to_string(text.size()) +
        " bytes");
  }
} // namespace slipstick::scene
