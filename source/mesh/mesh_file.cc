#include <slipstick/base/exceptions.h>
#include <slipstick/mesh/mesh_file.h>

#include <algorithm>
#include <cctype>
#include <filesystem>
#include <fstream>
#include <sstream>

namespace slipstick::mesh
{
  namespace
  {
    std::string content_of(const std::string &file)
    {
      std::ifstream      in(file, std::ios::binary);
      std::ostringstream text;
      text << in.rdbuf();
      if (!in)
        throw InputError("mesh file " + file + " cannot be read, or is empty", "check its path and permissions");
      return text.str();
    }

  } // namespace

  std::string MeshFile::name_of(const unsigned int dim, const int physical) const
  {
    const auto found = names.find({dim, physical});
    return found == names.end() ? std::to_string(physical) : found->second;
  }

  bool MeshFile::is_in(const Element &element, const std::string &part) const
  {
    if (part.empty())
      return true;
    for (const int physical : groups[element.group])
      if (name_of(element.dim, physical) == part || std::to_string(physical) == part)
        return true;
    return false;
  }

  MeshFile::Element MeshFile::Side::element() const
  {
    Element result;
    result.n   = n();
    result.dim = result.n == 2 ? 1 : 2;
    std::copy_n(corners.begin(), result.n, result.corners.begin());
    return result;
  }

  unsigned int MeshFile::dimension() const
  {
    return std::any_of(elements.begin(), elements.end(), [](const auto &element) { return element.dim == 3; }) ? 3 : 2;
  }

  std::vector<MeshFile::Side> sides_of(const MeshFile::Element &cell)
  {
    constexpr unsigned int no_corner = MeshFile::Side::no_corner;
    // by corners; pyramids and wedges are missing, since they are refused
    static const std::vector<std::array<unsigned int, 4>> of_tetrahedron = {{{0, 1, 2, no_corner}},
                                                                            {{0, 3, 1, no_corner}},
                                                                            {{1, 3, 2, no_corner}},
                                                                            {{2, 3, 0, no_corner}}};
    static const std::vector<std::array<unsigned int, 4>> of_hexahedron =
      {{{0, 1, 2, 3}}, {{4, 7, 6, 5}}, {{0, 4, 5, 1}}, {{1, 5, 6, 2}}, {{2, 6, 7, 3}}, {{3, 7, 4, 0}}};
    std::vector<MeshFile::Side> sides;
    if (cell.dim == 2)
      for (unsigned int k = 0; k < cell.n; ++k)
        sides.push_back({{{cell.corners[k], cell.corners[(k + 1) % cell.n], no_corner, no_corner}}});
    if (cell.dim == 3 && (cell.n == 4 || cell.n == 8))
      for (const auto &local : cell.n == 4 ? of_tetrahedron : of_hexahedron)
        {
          sides.emplace_back();
          for (unsigned int k = 0; k < 4; ++k)
            if (local[k] != no_corner)
              sides.back().corners[k] = cell.corners[local[k]];
        }
    return sides;
  }

  void MeshFile::add_sides_of_node_set(const std::string &name, const unsigned int group)
  {
    std::vector<bool> is_in(nodes.size(), false);
    const auto       &set = node_sets.at(name);
    for (const unsigned int node : set)
      is_in[node] = true;
    const auto add = [&](Element element) {
      element.group   = group;
      element.implied = true;
      elements.push_back(element);
    };
    if (set.size() == 1)
      {
        Element point;
        point.n          = 1;
        point.corners[0] = set[0];
        add(point);
        node_sets.erase(name);
        return;
      }
    const std::size_t  n_elements = elements.size();
    const unsigned int dim        = dimension();
    for (std::size_t e = 0; e < n_elements; ++e)
      if (elements[e].dim == dim)
        for (const Side &side : sides_of(elements[e]))
          if (std::all_of(side.corners.begin(), side.corners.begin() + side.n(), [&](const auto k) {
                return is_in[k];
              }))
            add(side.element());
  }

  void MeshFile::add_outline()
  {
    const unsigned int  dim = dimension();
    std::map<Side, int> n_cells; // negative: there is a line or face already
    for (const Element &element : elements)
      if (element.dim == dim)
        for (const Side &side : sides_of(element))
          ++n_cells[side.sorted()];
      else if (element.dim + 1 == dim)
        {
          Side side;
          std::copy_n(element.corners.begin(), element.n, side.corners.begin());
          n_cells[side.sorted()] = -1000000;
        }
    for (const auto &[side, n] : n_cells)
      if (n == 1)
        {
          elements.push_back(side.element());
          elements.back().group = groups.size();
        }
    groups.push_back({0});
  }

  MeshFile read_mesh_file(const std::string &file)
  {
    return parse_mesh_file(file, content_of(file));
  }

  MeshFile parse_mesh_file(const std::string &file, const std::string &text)
  {
    std::string extension = std::filesystem::path(file).extension().string();
    std::transform(extension.begin(), extension.end(), extension.begin(), [](const unsigned char c) {
      return std::tolower(c);
    });
    if (extension == ".msh")
      return parse_gmsh(file, text);
    if (text.find('\0') != std::string::npos)
      throw InputError("mesh file " + file + " is binary, or damaged: its byte " + std::to_string(text.find('\0') + 1) +
                         " is 0",
                       "write it in ASCII, or as Gmsh's .msh");
    // .inp is Abaqus' or UCD's format: UCD starts with numbers, Abaqus with words
    const auto first = text.find_first_not_of(" \t\r\n");
    if (extension == ".inp" && first != std::string::npos && !std::isdigit(text[first]) && text[first] != '#')
      return parse_abaqus(file, text);
    if (extension != ".inp" && extension != ".ucd" && extension != ".unv" && extension != ".vtk")
      throw InputError("mesh file " + file + " has the unknown ending '" + extension + "'",
                       "give .msh (Gmsh), .inp (Abaqus), .ucd, .unv or .vtk");
    return extension == ".vtk"   ? parse_vtk(file, text)
           : extension == ".unv" ? parse_unv(file, text)
                                 : parse_ucd(file, text);
  }
} // namespace slipstick::mesh
