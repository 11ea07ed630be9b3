// Mesh files: Gmsh's .msh, Abaqus' .inp, .vtk, .unv and .ucd.
#pragma once

#include <slipstick/base/remark.h>

#include <deal.II/base/point.h>

#include <algorithm>
#include <array>
#include <map>
#include <set>
#include <string>
#include <vector>

namespace slipstick::mesh
{
  /// Contents of a mesh file, unchanged: in the units of the file, including unused nodes.
  struct MeshFile
  {
    struct Element
    {
      unsigned int                dim = 0; // 0 point, 1 line, 2 triangle or quadrilateral, 3 solid
      unsigned int                n   = 0; // number of corners
      std::array<unsigned int, 8> corners =
        {};                               // indices into nodes; counterclockwise or all clockwise; of hexahedra the
                                          // bottom around, then the top
      unsigned int       group   = 0;     // index into groups
      unsigned long long number  = 0;     // in the file, for messages
      bool               implied = false; // an edge between nodes of a set, may be inside a body
    };

    /// An edge of a plane cell, a face of a solid: its corners in cyclic order, followed by no_corner.
    struct Side
    {
      static constexpr unsigned int no_corner = -1;

      std::array<unsigned int, 4> corners{{no_corner, no_corner, no_corner, no_corner}};

      unsigned int n() const
      {
        return std::find(corners.begin(), corners.end(), no_corner) - corners.begin();
      }

      /// With sorted corners: the same for both adjacent cells.
      Side sorted() const
      {
        Side result = *this;
        std::sort(result.corners.begin(), result.corners.end());
        return result;
      }

      /// The side as a line or face element of the file.
      Element element() const;

      bool operator<(const Side &other) const
      {
        return corners < other.corners;
      }
    };

    std::string                                      file;
    std::vector<dealii::Point<3>>                    nodes;
    std::vector<Element>                             elements;
    std::vector<std::vector<int>>                    groups;            // sets of physical numbers that elements carry
    std::map<std::pair<int, int>, std::string>       names;             // by dimension and physical number
    bool                                             is_curved = false; // has nodes besides the corners
    std::map<std::string, std::vector<unsigned int>> node_sets; // by name: nodes whose edges or faces are a boundary
    std::vector<Remark>                              remarks;   // unused content of the file, for the log
    std::string           about_names; // of the format: why a name may be missing; for remedies, or empty
    std::set<std::string> plane_stress_types, plane_strain_types, axisymmetric_types; // element types, by use

    /// Mid nodes of the edges of second-order cells, by the two corners in ascending order.
    std::map<std::pair<unsigned int, unsigned int>, unsigned int> middles;

    /// Stores node number @p k (from 0, corners first) of a second-order cell, whose corners are set, if it is the
    /// midpoint of an edge.
    void keep_middle(const Element &cell, const unsigned int k, const unsigned int node)
    {
      if (k < cell.n || k >= 2 * cell.n)
        return;
      const unsigned int a = cell.corners[k - cell.n], b = cell.corners[(k - cell.n + 1) % cell.n];
      middles[{std::min(a, b), std::max(a, b)}] = node;
    }

    /// The same for quadrilateral faces of solids, by their corners in ascending order.
    std::map<std::array<unsigned int, 4>, unsigned int> middles_of_faces;

    /// Stores a node of a second-order solid that is in the middle of an edge or a face.
    /// @param between the corners of the cell between which it lies.
    void keep_middle_of_solid(const Element &cell, const std::vector<unsigned int> &between, const unsigned int node)
    {
      if (between.size() == 2)
        middles[std::minmax({cell.corners[between[0]], cell.corners[between[1]]})] = node;
      if (between.size() != 4)
        return;
      std::array<unsigned int, 4> face;
      for (unsigned int k = 0; k < 4; ++k)
        face[k] = cell.corners[between[k]];
      std::sort(face.begin(), face.end());
      middles_of_faces[face] = node;
    }

    /// Physical name of a number, or the number itself if it has no name.
    std::string name_of(const unsigned int dim, const int physical) const;

    /// Whether the element belongs to @p part, a physical name or number; an empty one means all.
    bool is_in(const Element &element, const std::string &part) const;

    /// 3 if there are solids, otherwise 2.
    unsigned int dimension() const;

    /// Adds lines or faces of @p group for all sides of cells with all corners in node_sets[name], or a point for a
    /// single node.
    void add_sides_of_node_set(const std::string &name, const unsigned int group);

    /// Adds lines or faces of number 0 for sides of only one cell that have none yet: the outline is boundary number 0.
    void add_outline();
  };

  /// Sides of a plane cell or a solid in Abaqus' order (S1, S2, ...).
  std::vector<MeshFile::Side> sides_of(const MeshFile::Element &cell);

  /// Reads .msh (Gmsh 2.0 to 2.2 and 4.1, ASCII and binary), .inp (Abaqus), .ucd (and UCD's .inp), .vtk, whose
  /// boundaries and parts have numbers instead of names, and .unv.
  /// @throws InputError that names the file, the fault and a remedy.
  MeshFile read_mesh_file(const std::string &file);

  /// The same from @p text, the whole content of @p file.
  MeshFile parse_mesh_file(const std::string &file, const std::string &text);

  /// Gmsh's format from @p text, the whole content of @p file.
  MeshFile parse_gmsh(const std::string &file, const std::string &text);

  /// Abaqus' format. Element sets are parts (and boundaries if they contain lines, or faces of solids), surfaces are
  /// boundaries; a node set is the boundary of all edges, or faces of solids, between its nodes; a single node is a
  /// point.
  MeshFile parse_abaqus(const std::string &file, const std::string &text);

  /// VTK's legacy format in ASCII, unstructured grids of versions 2 to 5. Groups are the integers of the first cell
  /// data with one of the usual names (MaterialID, CellEntityIds, ...).
  MeshFile parse_vtk(const std::string &file, const std::string &text);

  /// I-deas' universal format: data sets 2411 (nodes), 2412 (elements), 2467 and 2477 (groups).
  MeshFile parse_unv(const std::string &file, const std::string &text);

  /// AVS' unstructured cell data in ASCII: groups are the material numbers.
  MeshFile parse_ucd(const std::string &file, const std::string &text);
} // namespace slipstick::mesh
