// VTK's legacy format: https://docs.vtk.org/en/latest/design_documents/VTKFileFormats.html, "Simple legacy formats".
#include <slipstick/base/text.h>
#include <slipstick/mesh/mesh_file.h>
#include <slipstick/mesh/solid_nodes.h>
#include <slipstick/mesh/word_reader.h>

#include <algorithm>
#include <cctype>
#include <cmath>

namespace slipstick::mesh
{
  namespace
  {
    /// VTK's cell types: dimension, corners, all nodes; 0 nodes: not supported.
    struct CellType
    {
      unsigned int dim, n_corners, n_nodes;
    };

    CellType cell_type(const long long type)
    {
      switch (type)
        {
          case 1:
            return {0, 1, 1};
          case 3:
            return {1, 2, 2};
          case 21:
            return {1, 2, 3};
          case 5:
            return {2, 3, 3};
          case 22:
            return {2, 3, 6};
          case 34:
            return {2, 3, 7};
          case 9:
            return {2, 4, 4};
          case 23:
            return {2, 4, 8};
          case 28:
            return {2, 4, 9};
          case 10:
            return {3, 4, 4};
          case 24:
            return {3, 4, 10};
          case 12:
            return {3, 8, 8};
          case 25:
            return {3, 8, 20};
          case 29:
            return {3, 8, 27};
          case 13:
            return {3, 6, 6};
          case 14:
            return {3, 5, 5};
        }
      return {0, 0, 0};
    }

    class VtkReader
    {
    public:
      VtkReader(const std::string &file, const std::string &text)
        : in(
            file,
            text,
            "write it again (legacy .vtk in ASCII with an unstructured grid of triangles, quadrilaterals, tetrahedra and "
            "hexahedra of first or second order), or save it as .msh in Gmsh")
      {
        mesh.file = file;
        mesh.about_names =
          "; .vtk files have numbers in place of names (Gmsh's those of the physical groups, of several at an element "
          "the first): save as .msh in Gmsh for the names";
      }

      MeshFile read();

    private:
      void read_header();
      void read_points();
      void read_cells();
      void read_types();
      void read_data();
      void read_array(const std::string &name, const std::size_t n_values);
      void make_groups();

      WordReader                          in;
      MeshFile                            mesh;
      std::vector<std::vector<long long>> corners; // by cell
      std::vector<long long>              ids;     // by cell, from the array that defines groups
      std::string                         source_of_ids;
      bool                                of_cells = false; // the data being read belong to cells
      std::size_t                         n_data   = 0;
    };

    void VtkReader::read_header()
    {
      in.section = "header";
      if (in.line().compare(0, 14, "# vtk DataFile") != 0)
        in.fail("is not a legacy .vtk file: it does not start with '# vtk DataFile'");
      in.line(); // its title
      if (!in.skip("ASCII"))
        in.fail("is not in ASCII");
      if (!in.skip("DATASET") || !in.skip("UNSTRUCTURED_GRID"))
        in.fail("holds no DATASET UNSTRUCTURED_GRID");
    }

    void VtkReader::read_points()
    {
      const auto n = in.count(5);
      in.word(); // their type
      for (std::size_t k = 0; k < n; ++k)
        {
          const double x = in.real(), y = in.real(), z = in.real();
          mesh.nodes.emplace_back(x, y, z);
        }
    }

    void VtkReader::read_cells()
    {
      const auto n = in.count(2), n_entries = in.count(1);
      if (in.skip("OFFSETS")) // version 5
        {
          in.word();
          std::vector<long long> offsets;
          for (std::size_t c = 0; c < n; ++c)
            offsets.push_back(in.integer());
          if (!in.skip("CONNECTIVITY"))
            in.fail_corrupt();
          in.word();
          if (n == 0 || offsets.front() != 0 || offsets.back() != static_cast<long long>(n_entries))
            in.fail_corrupt();
          for (std::size_t c = 0; c + 1 < n; ++c)
            {
              if (offsets[c + 1] < offsets[c])
                in.fail_corrupt();
              corners.emplace_back();
              for (long long k = offsets[c]; k < offsets[c + 1]; ++k)
                corners.back().push_back(in.integer());
            }
        }
      else
        {
          std::size_t read = 0;
          for (std::size_t c = 0; c < n; ++c)
            {
              const auto of_cell = in.count(2);
              corners.emplace_back();
              for (std::size_t k = 0; k < of_cell; ++k)
                corners.back().push_back(in.integer());
              read += of_cell + 1;
            }
          if (read != n_entries)
            in.fail_corrupt();
        }
      for (std::size_t c = 0; c < corners.size(); ++c)
        for (const long long corner : corners[c])
          if (corner < 0 || corner >= static_cast<long long>(mesh.nodes.size()))
            in.fail("cell " + std::to_string(c) + " has corner " + std::to_string(corner) +
                    ", which is not in the file");
    }

    void VtkReader::read_types()
    {
      const auto n = in.count(2);
      if (n != corners.size())
        in.fail("has " + std::to_string(corners.size()) + " cells, but " + std::to_string(n) + " types of cells");
      for (std::size_t c = 0; c < n; ++c)
        {
          const auto type  = in.integer();
          const auto known = cell_type(type);
          if (known.n_nodes == 0 && known.dim == 0)
            in.fail("cell " + std::to_string(c) + " is of type " + std::to_string(type) + ", which is not supported");
          if (corners[c].size() != known.n_nodes)
            in.fail("cell " + std::to_string(c) + " of type " + std::to_string(type) + " has " +
                    std::to_string(corners[c].size()) + " corners");
          MeshFile::Element element;
          element.dim          = known.dim;
          element.n            = known.n_corners;
          element.number       = c;
          const auto &of_solid = middles_of_solid(NodeOrder::vtk, known.dim == 3 ? known.n_nodes : 0);
          for (unsigned int k = 0; k < known.n_nodes; ++k)
            if (k < known.n_corners)
              element.corners[k] = corners[c][k];
            else if (known.dim == 2)
              mesh.keep_middle(element, k, corners[c][k]);
            else if (known.dim == 3 && k - known.n_corners < of_solid.size())
              mesh.keep_middle_of_solid(element, of_solid[k - known.n_corners], corners[c][k]);
          mesh.is_curved = mesh.is_curved || (known.dim >= 2 && known.n_nodes > known.n_corners);
          mesh.elements.push_back(element);
        }
    }

    /// Groups are defined by the first cell data with one integer per cell; other data are reported as unused.
    void VtkReader::read_array(const std::string &name, const std::size_t n_values)
    {
      std::vector<double> values;
      for (std::size_t k = 0; k < n_values; ++k)
        values.push_back(in.real());
      const bool is_whole = std::all_of(values.begin(), values.end(), [](const double v) {
        return v == std::floor(v) && std::abs(v) < 1e9;
      });
      if (of_cells && source_of_ids.empty() && is_whole && n_values == n_data && n_data == mesh.elements.size())
        {
          source_of_ids = name;
          ids.assign(values.begin(), values.end());
        }
      else
        mesh.remarks.push_back("mesh file " + mesh.file + ": not used: " + (of_cells ? "cell" : "point") + " data '" +
                               name + "'");
    }

    void VtkReader::read_data()
    {
      for (std::string word = in.word(); !word.empty(); word = in.word())
        {
          in.section = word;
          if (word == "CELL_DATA" || word == "POINT_DATA")
            {
              of_cells            = word == "CELL_DATA";
              n_data              = in.count(1);
              const auto expected = of_cells ? mesh.elements.size() : mesh.nodes.size();
              if (n_data != expected)
                in.fail("has " + word + " for " + std::to_string(n_data) + ", but " + std::to_string(expected) +
                        (of_cells ? " cells" : " points"));
            }
          else if (word == "SCALARS")
            {
              const std::string              name = in.word();
              const std::vector<std::string> rest = split_list(collapse_blanks(in.line()), ' '); // type, components
              const auto                     components = rest.size() > 1 ? parse_number(rest[1]).value_or(0) : 1;
              if (!(components >= 1 && components <= 4))
                in.fail_corrupt();
              if (in.skip("LOOKUP_TABLE"))
                in.word();
              read_array(name, n_data * static_cast<std::size_t>(components));
            }
          else if (word == "VECTORS" || word == "NORMALS" || word == "TENSORS")
            {
              const std::string name = in.word();
              in.word();
              read_array(name, n_data * (word == "TENSORS" ? 9 : 3));
            }
          else if (word == "FIELD")
            {
              in.word();
              for (auto n = in.count(4); n > 0; --n)
                {
                  const std::string name       = in.word();
                  const auto        components = in.count(1), n_tuples = in.count(1);
                  in.word();
                  if (components > 0 && n_tuples > n_data)
                    in.fail_corrupt();
                  read_array(name, components * n_tuples);
                }
            }
          else if (word == "METADATA")
            {
              in.line();
              while (!in.at_end() && !in.line().empty())
                ;
            }
          else
            in.fail("has a section '" + word + "' that is not supported");
        }
    }

    void VtkReader::make_groups()
    {
      std::map<long long, unsigned int> group_of;
      for (std::size_t c = 0; c < mesh.elements.size(); ++c)
        {
          const long long id         = ids.empty() ? 0 : ids[c];
          const auto [found, is_new] = group_of.emplace(id, mesh.groups.size());
          if (is_new)
            mesh.groups.push_back({static_cast<int>(id)});
          mesh.elements[c].group = found->second;
        }
      mesh.add_outline();
    }

    MeshFile VtkReader::read()
    {
      read_header();
      const auto enter = [this](const std::string &section) {
        if (!in.skip(section))
          in.section.empty() ? in.fail("lacks its section " + section) : in.fail_corrupt();
        in.section = section;
      };
      in.section.clear();
      enter("POINTS");
      read_points();
      if (in.skip("METADATA"))
        {
          in.line();
          while (!in.at_end() && !in.line().empty())
            ;
        }
      enter("CELLS");
      read_cells();
      enter("CELL_TYPES");
      read_types();
      read_data();
      make_groups();
      return std::move(mesh);
    }
  } // namespace

  MeshFile parse_vtk(const std::string &file, const std::string &text)
  {
    return VtkReader(file, text).read();
  }
} // namespace slipstick::mesh
