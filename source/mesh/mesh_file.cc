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

  void MeshFile::add_edges_of_node_set(const std::string &name, const unsigned int group)
  {
    std::vector<bool> is_in(nodes.size(), false);
    const auto       &set = node_sets.at(name);
    for (const unsigned int node : set)
      is_in[node] = true;
    const auto add = [&](const unsigned int dim, const unsigned int a, const unsigned int b) {
      Element element;
      element.dim     = dim;
      element.n       = dim + 1;
      element.corners = {{a, b, 0, 0}};
      element.group   = group;
      element.implied = true;
      elements.push_back(element);
    };
    if (set.size() == 1)
      {
        add(0, set[0], 0);
        node_sets.erase(name);
        return;
      }
    const std::size_t n_elements = elements.size();
    for (std::size_t e = 0; e < n_elements; ++e)
      if (const auto cell = elements[e]; cell.dim == 2)
        for (unsigned int k = 0; k < cell.n; ++k)
          if (is_in[cell.corners[k]] && is_in[cell.corners[(k + 1) % cell.n]])
            add(1, cell.corners[k], cell.corners[(k + 1) % cell.n]);
  }

  void MeshFile::add_outline()
  {
    std::map<std::pair<unsigned int, unsigned int>, int> n_cells; // by edge; negative: there is a line
    for (const Element &element : elements)
      if (element.dim == 1)
        n_cells[std::minmax(element.corners[0], element.corners[1])] = -1000000;
      else if (element.dim == 2)
        for (unsigned int k = 0; k < element.n; ++k)
          ++n_cells[std::minmax(element.corners[k], element.corners[(k + 1) % element.n])];
    for (const auto &[edge, n] : n_cells)
      if (n == 1)
        {
          Element element;
          element.dim     = 1;
          element.n       = 2;
          element.corners = {{edge.first, edge.second, 0, 0}};
          element.group   = groups.size();
          elements.push_back(element);
        }
    groups.push_back({0});
  }

  MeshFile read_mesh_file(const std::string &file)
  {
    const std::string text      = content_of(file);
    std::string       extension = std::filesystem::path(file).extension().string();
    std::transform(extension.begin(), extension.end(), extension.begin(), [](const unsigned char c) {
      return std::tolower(c);
    });
    if (extension == ".msh")
      return parse_gmsh(file, text);
    if (text.find('\0') != std::string::npos)
      throw InputError("mesh file " + file + " is binary, or damaged: its byte " + std::to_string(text.find('\0') + 1) +
                         " is 0",
                       "write it in ASCII, or as Gmsh's .msh");
    // .inp is Abaqus' or UCD's: UCD starts with numbers, Abaqus with words
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
