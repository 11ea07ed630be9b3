#include <slipstick/base/exceptions.h>
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

    /// deal.II's name of a format; .inp is Abaqus' or UCD's: UCD starts with numbers, Abaqus with words.
    std::string format_of(const std::string &extension, const std::string &text)
    {
      if (extension == ".unv")
        return "unv";
      if (extension == ".vtk")
        return "vtk";
      if (extension == ".ucd")
        return "ucd";
      const auto first = text.find_first_not_of(" \t\r\n");
      if (extension == ".inp")
        return first != std::string::npos && (std::isdigit(text[first]) || text[first] == '#') ? "ucd" : "abaqus";
      return "";
    }

    /// First line of what deal.II says, without the frame around its exceptions.
    std::string first_words(const std::exception &error)
    {
      std::istringstream lines(error.what());
      std::string        line, words;
      while (std::getline(lines, line))
        if (!line.empty() && line[0] != '-' && line.find("An error occurred") == std::string::npos &&
            line.find("The violated condition") == std::string::npos)
          words += (words.empty() ? "" : " ") + line.substr(line.find_first_not_of(" \t") % line.size());
      return words.substr(0, 300);
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
                      format == "unv"   ? dealii::GridIn<2>::unv
                      : format == "vtk" ? dealii::GridIn<2>::vtk
                      : format == "ucd" ? dealii::GridIn<2>::ucd
                                        : dealii::GridIn<2>::abaqus);
        }
      catch (const std::exception &error)
        {
          throw InputError(
            "mesh file " + file + " could not be read as " + format + " in the plane: " + first_words(error),
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
    const std::string format = format_of(extension, text);
    if (format.empty())
      throw InputError("mesh file " + file + " has the unknown ending '" + extension + "'",
                       "give .msh (Gmsh), .inp (Abaqus), .ucd, .unv or .vtk");
    return through_deal_ii(file, text, format);
  }
} // namespace slipstick::fem
