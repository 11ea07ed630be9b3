#include <slipstick/base/exceptions.h>
#include <slipstick/base/text.h>
#include <slipstick/fem/mesh_file.h>

#include <deal.II/grid/grid_in.h>
#include <deal.II/grid/tria.h>

#include <algorithm>
#include <cctype>
#include <filesystem>
#include <fstream>
#include <set>
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

    /// What deal.II's readers of .vtk and .unv take from a file without looking, so that a spoilt one would crash or, worse,
    /// give another mesh: corners that are not there, lists of different lengths.
    class NumberCheck
    {
    public:
      NumberCheck(const std::string &file, const std::string &text)
        : file(file)
        , in(text)
      {}

      void vtk();
      void unv();

    private:
      [[noreturn]] void fail(const std::string &problem) const
      {
        throw InputError("mesh file " + file + ": " + problem,
                         "write it again, or convert it to Gmsh's .msh (legacy .vtk of version 3.0 in ASCII and .unv "
                         "with elements of types 11, 44 and 94 are read)");
      }

      template <typename T>
      T next(const std::string &section)
      {
        T value;
        if (!(in >> value))
          fail("is truncated or mixed up in its section " + section);
        return value;
      }

      void corner_is_there(const bool is_there, const long long corner, const long long cell) const
      {
        if (!is_there)
          fail("cell " + std::to_string(cell) + " has corner " + std::to_string(corner) + ", which is not in the file");
      }

      const std::string &file;
      std::istringstream in;
    };

    void NumberCheck::vtk()
    {
      std::string word;
      for (unsigned int line = 0; line < 4; ++line)
        std::getline(in, word);
      if (!(in >> word) || word != "POINTS")
        return; // deal.II says so
      const auto n_points = next<unsigned int>("POINTS");
      next<std::string>("POINTS"); // their type
      for (std::size_t k = 0; k < 3 * std::size_t(n_points); ++k)
        next<double>("POINTS");
      if (!(in >> word) || word != "CELLS")
        return;
      const auto n_cells = next<unsigned int>("CELLS");
      next<unsigned int>("CELLS"); // number of entries
      std::vector<unsigned int> n_corners;
      for (unsigned int c = 0; c < n_cells; ++c)
        {
          n_corners.push_back(next<unsigned int>("CELLS"));
          for (unsigned int k = 0; k < n_corners.back(); ++k)
            {
              const auto corner = next<unsigned int>("CELLS");
              corner_is_there(corner < n_points, corner, c);
            }
        }
      if (next<std::string>("CELLS") != "CELL_TYPES")
        fail("is truncated or mixed up in its section CELLS");
      if (const auto n_types = next<unsigned int>("CELL_TYPES"); n_types != n_cells)
        fail("has " + std::to_string(n_cells) + " cells, but " + std::to_string(n_types) + " types of cells");
      const std::map<unsigned int, unsigned int> corners_of_type = {{3, 2}, {5, 3}, {9, 4}};
      for (unsigned int c = 0; c < n_cells; ++c)
        if (const auto found = corners_of_type.find(next<unsigned int>("CELL_TYPES"));
            found != corners_of_type.end() && found->second != n_corners[c])
          fail("cell " + std::to_string(c) + " of type " + std::to_string(found->first) + " has " +
               std::to_string(n_corners[c]) + " corners");
    }

    void NumberCheck::unv()
    {
      std::string line;
      while (std::getline(in, line) && trim(line) != "2411")
        ;
      std::set<int> nodes;
      for (int node = next<int>("2411"); node != -1; node = next<int>("2411"))
        {
          for (unsigned int k = 0; k < 6; ++k)
            next<double>("2411"); // three numbers, three coordinates
          if (!nodes.insert(node).second)
            fail("node " + std::to_string(node) + " comes twice");
        }
      if (next<int>("2411") != -1 || next<int>("2412") != 2412)
        return; // deal.II says so
      for (int cell = next<int>("2412"); cell != -1; cell = next<int>("2412"))
        {
          const int type = next<int>("2412");
          if (type != 11 && type != 44 && type != 94)
            return;
          for (unsigned int k = 0; k < (type == 11 ? 7 : 4); ++k)
            next<int>("2412");
          for (unsigned int k = 0; k < (type == 11 ? 2 : 4); ++k)
            {
              const int corner = next<int>("2412");
              corner_is_there(nodes.count(corner) > 0, corner, cell);
            }
        }
    }

    MeshFile through_deal_ii(const std::string &file, const std::string &text, const std::string &format)
    {
      if (format == ".vtk")
        NumberCheck(file, text).vtk();
      else if (format == ".unv")
        NumberCheck(file, text).unv();
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
