#include <slipstick/mesh/abaqus_element.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cstdlib>
#include <vector>

namespace slipstick::mesh
{
  namespace
  {
    // Elements that are not part of a mesh, by the first letters of their types.
    const std::vector<std::string> other_elements =
      {"MASS", "ROTARYI", "HEATCAP", "SPRING", "DASHPOT", "CONN", "GAP", "DCOUP", "JOINTC", "ITS"};

    // Solids: number of nodes and corners of tetrahedra, hexahedra; pyramids and wedges, which are refused by name if a
    // body contains some.
    constexpr std::array<std::array<unsigned int, 2>, 8> solids = {
      {{{4, 4}}, {{10, 4}}, {{8, 8}}, {{20, 8}}, {{5, 5}}, {{13, 5}}, {{6, 6}}, {{15, 6}}}};
  } // namespace

  AbaqusElement abaqus_element(const std::string &type)
  {
    const auto starts = [&type](const std::string &prefix) { return type.compare(0, prefix.size(), prefix) == 0; };
    const auto starts_with_any = [&](const std::vector<std::string> &prefixes) {
      return std::any_of(prefixes.begin(), prefixes.end(), starts);
    };
    AbaqusElement found;
    if (starts_with_any({"CGAX", "DCAX", "ACAX", "SAX", "MAX", "CAXA"}))
      {
        found.problem = "elements of type " + type +
                        " are axisymmetric with twist, for heat or sound, or shells: only CAX3, CAX4, "
                        "CAX6 and CAX8 are supported";
        return found;
      }
    found.problem = "elements of type " + type + " are not supported"; // default, replaced for supported types
    if (starts("C3D"))
      {
        found.dim     = 3;
        found.n_nodes = std::strtoul(type.c_str() + 3, nullptr, 10);
        for (const auto &[n_nodes, n_corners] : solids)
          if (found.n_nodes == n_nodes)
            {
              found.n_corners = n_corners;
              found.problem.clear();
            }
        return found;
      }
    for (const std::string candidate : {"CPEG", "CPS", "CPE", "CAX", "STRI", "DC2D", "AC2D", "M3D", "SFM3D", "S"})
      if (found.dim == 0 && starts(candidate) && type.size() > candidate.size() && std::isdigit(type[candidate.size()]))
        {
          found.dim       = 2;
          found.n_nodes   = type[candidate.size()] - '0';
          found.n_corners = found.n_nodes % 3 == 0 ? 3 : 4;
          if (found.n_nodes == 3 || found.n_nodes == 4 || found.n_nodes == 6 || found.n_nodes == 8)
            found.problem.clear();
        }
    if (found.dim == 2)
      return found;
    if (starts_with_any({"T2D2", "T3D2", "B21", "B31", "B23", "B33", "R2D2", "RB2D2"}))
      return {1, 2, 2, ""};
    if (starts_with_any({"T2D3", "T3D3", "B22", "B32"}))
      return {1, 3, 2, ""};
    if (starts_with_any(other_elements))
      found.problem.clear();
    return found;
  }
} // namespace slipstick::mesh
