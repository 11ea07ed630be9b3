#include <slipstick/base/exceptions.h>
#include <slipstick/base/text.h>
#include <slipstick/mesh/gmsh_cursor.h>

#include <algorithm>
#include <cstdlib>
#include <limits>

namespace slipstick::mesh
{
  GmshCursor::GmshCursor(const std::string &file_name, const std::string &content)
    : file(file_name)
    , text(content)
  {}

  void GmshCursor::fail(const std::string &problem, const std::string &remedy) const
  {
    throw InputError("mesh file " + file + ": " + problem + (section.empty() ? "" : " (section $" + section + ")"),
                     remedy);
  }

  void GmshCursor::fail_broken() const
  {
    fail(std::string("is truncated or corrupt: ") +
           (binary ? "its size does not match its own counts" : "not the number expected here") + " at byte " +
           std::to_string(at),
         "write it again with Gmsh (copying in text mode damages a binary file), for example: gmsh -2 part.geo "
         "-format msh41");
  }

  int GmshCursor::physical(const int number) const
  {
    if (number == std::numeric_limits<int>::min()) // has no absolute value
      fail_broken();
    return std::abs(number);
  }

  std::size_t GmshCursor::checked(const std::size_t n, const std::size_t least) const
  {
    if (n > (text.size() - at) / least)
      fail_broken();
    return n;
  }

  std::string GmshCursor::line()
  {
    const auto end   = std::min(text.find('\n', at), text.size());
    const auto start = at;
    at               = std::min(end + 1, text.size());
    return trim(text.substr(start, end - start));
  }

  std::string GmshCursor::quoted()
  {
    const auto start = text.find('"', at), end = text.find('"', start + 1);
    if (start == std::string::npos || end == std::string::npos)
      fail_broken();
    at = end + 1;
    if (text.find('\0', start) < end) // a null character would truncate messages
      fail_broken();
    return text.substr(start + 1, end - start - 1);
  }

  std::string GmshCursor::next_section()
  {
    section.clear();
    at = text.find('$', at);
    if (at == std::string::npos)
      return "";
    section = line().substr(1);
    section = section.substr(0, section.find('\0')); // a null character would truncate messages
    return section;
  }

  void GmshCursor::end_section(const bool skip)
  {
    const std::string end   = "$End" + section;
    const auto        found = text.find(end, at);
    if (found == std::string::npos || (!skip && text.find_first_not_of(" \t\r\n", at) != found))
      fail_broken();
    at = found + end.size();
  }
} // namespace slipstick::mesh
