// A piece of mesh as plain lists, which can be cut, sent between ranks and converted to a triangulation.
#pragma once

#include <slipstick/mesh/mesh.h>

#include <deal.II/base/geometry_info.h>

#include <boost/serialization/array.hpp>
#include <boost/serialization/map.hpp>
#include <boost/serialization/vector.hpp>

#include <algorithm>
#include <array>
#include <limits>

namespace slipstick::mesh
{
  /// Cells, vertices and boundary faces of one subdomain (or of a whole body before it is cut).
  template <int dim>
  struct MeshPiece
  {
    static constexpr unsigned int vertices_per_cell = dealii::GeometryInfo<dim>::vertices_per_cell;
    static constexpr unsigned int vertices_per_face = dealii::GeometryInfo<dim>::vertices_per_face;

    /// Fills the unused entries of a simplex.
    static constexpr unsigned int no_vertex = std::numeric_limits<unsigned int>::max();

    /// Local vertices in deal.II's order: lexicographic for quadrilaterals and hexahedra, counterclockwise for
    /// triangles; for a tetrahedron a triangle and a fourth vertex on the side from which the triangle is
    /// counterclockwise.
    using Cell = std::array<unsigned int, vertices_per_cell>;

    /// Local vertices of a face; a triangle in space has no_vertex as the last one.
    using Face = std::array<unsigned int, vertices_per_face>;

    /// Two vertices in ascending order.
    using Line = std::array<unsigned int, 2>;

    struct BoundaryFace
    {
      Face                       vertices;
      dealii::types::boundary_id id;
      BoundaryCurve<dim>         curve      = {};   // of an edge: runs from the first vertex to the second
      bool                       bends_cell = true; // new nodes are on the curve; otherwise on the chord

      template <class Archive>
      void serialize(Archive &archive, const unsigned int /*version*/)
      {
        archive &vertices &id &curve &bends_cell;
      }
    };

    unsigned int                    subdomain = 0;
    unsigned int                    body      = 0;
    std::vector<dealii::Point<dim>> vertices;
    std::vector<GlobalVertex>       global_vertices;
    std::vector<Cell>               cells;
    std::vector<BoundaryFace>       boundary_faces;  // of the body; all other faces are cuts
    bool                            ordered = false; // lines of neighbouring cells already have the same direction

    /// The midpoints of curved edges; in space all of them are on the boundary of the body. Other edges are straight.
    std::map<Line, dealii::Point<dim>> line_middles;

    /// For sending between ranks (Boost serialization, through deal.II's MPI utilities).
    template <class Archive>
    void serialize(Archive &archive, const unsigned int /*version*/)
    {
      archive &subdomain &body &vertices &global_vertices &cells &boundary_faces &ordered &line_middles;
    }
  };

  template <int dim>
  bool is_simplex(const typename MeshPiece<dim>::Cell &cell)
  {
    return cell.back() == MeshPiece<dim>::no_vertex;
  }

  /// Number of vertices (in the plane also of faces) of a cell.
  template <int dim>
  unsigned int n_corners(const typename MeshPiece<dim>::Cell &cell)
  {
    return is_simplex<dim>(cell) ? dim + 1 : MeshPiece<dim>::vertices_per_cell;
  }

  template <int dim>
  unsigned int n_faces(const typename MeshPiece<dim>::Cell &cell)
  {
    return is_simplex<dim>(cell) ? dim + 1 : dealii::GeometryInfo<dim>::faces_per_cell;
  }

  /// Corner @p k of a cell in counterclockwise order (cyclic: 0 after the last).
  template <int dim>
  unsigned int corner(const typename MeshPiece<dim>::Cell &cell, const unsigned int k)
  {
    static_assert(dim == 2, "around a cell of the plane");
    constexpr std::array<unsigned int, 4> around = {{0, 1, 3, 2}};
    return is_simplex<dim>(cell) ? cell[k % 3] : cell[around[k % 4]];
  }

  /// Cell of the given corners, counterclockwise.
  template <int dim>
  typename MeshPiece<dim>::Cell triangle(const unsigned int a, const unsigned int b, const unsigned int c)
  {
    return {{a, b, c, MeshPiece<dim>::no_vertex}};
  }

  /// Cell of the given corners, counterclockwise.
  template <int dim>
  typename MeshPiece<dim>::Cell quadrilateral(const unsigned int a,
                                              const unsigned int b,
                                              const unsigned int c,
                                              const unsigned int d)
  {
    return {{a, b, d, c}};
  }

  /// Face number @p f: from corner @p f to the next; of a tetrahedron the face opposite corner @p f; of a hexahedron
  /// deal.II's face @p f. Vertices in ascending order, i.e. the same from both sides.
  template <int dim>
  typename MeshPiece<dim>::Face face_of_cell(const typename MeshPiece<dim>::Cell &cell, const unsigned int f)
  {
    typename MeshPiece<dim>::Face face;
    if constexpr (dim == 2)
      face = {{corner<dim>(cell, f), corner<dim>(cell, f + 1)}};
    else if (is_simplex<dim>(cell))
      face = {{cell[(f + 1) % 4], cell[(f + 2) % 4], cell[(f + 3) % 4], MeshPiece<dim>::no_vertex}};
    else
      for (unsigned int v = 0; v < face.size(); ++v)
        face[v] = cell[dealii::GeometryInfo<dim>::face_to_cell_vertices(f, v)];
    std::sort(face.begin(), face.end());
    return face;
  }

  /// The edges of a solid, vertices in ascending order.
  inline std::vector<MeshPiece<3>::Line> lines_of_cell(const MeshPiece<3>::Cell &cell)
  {
    std::vector<MeshPiece<3>::Line> lines;
    const unsigned int              n = n_corners<3>(cell);
    for (unsigned int a = 0; a < n; ++a)
      for (unsigned int b = a + 1; b < n; ++b)
        if (const unsigned int step = a ^ b;
            n == 4 || (step & (step - 1)) == 0) // corners of a cube that differ in one coordinate
          lines.push_back({{std::min(cell[a], cell[b]), std::max(cell[a], cell[b])}});
    return lines;
  }

  /// All faces with their adjacent cells (one at the boundary, two inside), sorted by face.
  template <int dim>
  std::vector<std::pair<typename MeshPiece<dim>::Face, unsigned int>> faces_with_cells(const MeshPiece<dim> &piece);

  /// Boundary ids by face, vertices in ascending order.
  template <int dim>
  std::map<typename MeshPiece<dim>::Face, dealii::types::boundary_id> ids_of_faces(const MeshPiece<dim> &piece);

  /// The boundary faces by their vertices in ascending order; their own vertices and their curves have this order, too.
  template <int dim>
  std::map<typename MeshPiece<dim>::Face, typename MeshPiece<dim>::BoundaryFace> boundary_by_vertices(
    const MeshPiece<dim> &piece);

  /// Block @p block (of n_blocks per direction) of a rectangle or cuboid meshed by a lattice of equal cells, not yet
  /// placed.
  template <int dim>
  MeshPiece<dim> rectangle_piece(const scene::Body<dim>              &body,
                                 const std::array<unsigned int, dim> &n_cells,
                                 const std::array<unsigned int, dim> &n_blocks,
                                 const std::array<unsigned int, dim> &block);

  /// Mirrors, rotates and moves @p piece. Cells stay counterclockwise; identical vertices stay bitwise identical.
  template <int dim>
  void place(MeshPiece<dim> &piece, const scene::Placement<dim> &placement);

  /// Cuts @p whole into the parts given by @p part (a part number for every cell). Parts without cells are omitted;
  /// parts that are not connected through faces become several pieces. Pieces are ordered by part and first cell.
  template <int dim>
  std::vector<MeshPiece<dim>> cut(const MeshPiece<dim> &whole, const std::vector<unsigned int> &part);
} // namespace slipstick::mesh
