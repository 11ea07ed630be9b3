#include <slipstick/base/exceptions.h>
#include <slipstick/base/text.h>
#include <slipstick/fem/mesh_file.h>

#include <deal.II/grid/grid_in.h>
#include <deal.II/grid/tria.h>

#include <algorithm>
#include <cctype>
#include <filesystem>
#include <fstream>
#include <sstream>

namespace slipstick::fem
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

    /// What deal.II says, without the frame around its exceptions.
    std::string words_of(const std::exception &error)
    {
      std::string       text   = error.what();
      const std::string before = "Additional information:", after = "Stacktrace:";
      if (const auto start = text.find(before); start != std::string::npos)
        text = text.substr(start + before.size());
      text = collapse_blanks(text.substr(0, text.find(after)));
      return text.substr(0, text.find("--------"));
    }

    MeshFile through_deal_ii(const std::string &file, const std::string &text, const std::string &format)
    {
      MeshFile mesh;
      mesh.file = file;
      dealii::Triangulation<2> triangulation;
      try
        {
          dealii::GridIn<2>  reader(triangulation);
          std::istringstream in(text);
          reader.read(in,
                      format == ".unv"   ? dealii::GridIn<2>::unv
                      : format == ".vtk" ? dealii::GridIn<2>::vtk
                                         : dealii::GridIn<2>::ucd);
        }
      catch (const std::exception &error)
        {
          throw InputError(
            "mesh file " + file + " could not be read as " + format + " in the plane: " + words_of(error),
            "check that it holds a plane mesh of triangles and quadrilaterals, or convert it to Gmsh's .msh");
        }
      for (const auto &x : triangulation.get_vertices())
        mesh.nodes.emplace_back(x[0], x[1], 0);
      std::map<int, unsigned int> group_of; // by number
      const auto                  group = [&](const int number) {
        const auto [found, is_new] = group_of.emplace(number, mesh.groups.size());
        if (is_new)
          mesh.groups.push_back({number});
        return found->second;
      };
      for (const auto &cell : triangulation.active_cell_iterators())
        {
          MeshFile::Element element;
          element.dim    = 2;
          element.n      = cell->n_vertices();
          element.group  = group(cell->material_id());
          element.number = mesh.elements.size() + 1;
          for (unsigned int v = 0; v < element.n; ++v)
            element.corners[v] = cell->vertex_index(v);
          if (element.n == 4) // lexicographic there, around here
            std::swap(element.corners[2], element.corners[3]);
          mesh.elements.push_back(element);
        }
      for (const auto &cell : triangulation.active_cell_iterators())
        for (const auto &face : cell->face_iterators())
          if (face->at_boundary())
            {
              MeshFile::Element element;
              element.dim     = 1;
              element.n       = 2;
              element.corners = {{face->vertex_index(0), face->vertex_index(1), 0, 0}};
              element.group   = group(face->boundary_id());
              element.number  = mesh.elements.size() + 1;
              mesh.elements.push_back(element);
            }
      return mesh;
    }
  } // namespace

  MeshFile read_mesh_file(const std::string &file)
  {
    const std::string text      = content_of(file);
    std::string       extension = std::filesystem::path(file).extension().string();
    std::transform(extension.begin(), extension.end(), extension.begin(), [](const unsigned char c) {
      return std::tolower(c);
    });
    if (extension == ".msh")
      return parse_gmsh(file, text);
    // .inp is Abaqus' or UCD's: UCD starts with numbers, Abaqus with words
    const auto first = text.find_first_not_of(" \t\r\n");
    if (extension == ".inp" && first != std::string::npos && !std::isdigit(text[first]) && text[first] != '#')
      return parse_abaqus(file, text);
    if (extension != ".inp" && extension != ".ucd" && extension != ".unv" && extension != ".vtk")
      throw InputError("mesh file " + file + " has the unknown ending '" + extension + "'",
                       "give .msh (Gmsh), .inp (Abaqus), .ucd, .unv or .vtk");
    return through_deal_ii(file, text, extension);
  }
} // namespace slipstick::fem
