// Conforming local refinement; each refinement starts from the original mesh, so that cell shapes do not degrade.
#pragma once

#include <slipstick/mesh/mesh_piece.h>

#include <cstdint>
#include <map>
#include <set>
#include <utility>
#include <vector>

namespace slipstick::mesh
{
  /// Identifies a cell that results from a cell of the scene's mesh by regular divisions only: the number of that cell,
  /// followed by the number of each child. Independent of refinement elsewhere.
  using CellPath = std::vector<std::uint32_t>;

  /// The sorted global vertices of a cell; the last one of a triangle is no_vertex. Solids consist of tetrahedra here.
  using CellKey = std::array<GlobalVertex, 4>;

  /// The key of a cell with the global vertices @p vertices.
  CellKey cell_key(std::vector<GlobalVertex> vertices);

  /// The cells of the bodies that are refined beyond the scene's mesh. Stored on rank 0, empty on the others.
  struct Refinement
  {
    std::vector<std::set<CellPath>> refined; // by body

    /// For the mesh made last: body of each cell, and the path to add to `refined` in order to refine it.
    std::map<CellKey, std::pair<unsigned int, CellPath>> cells;
  };

  template <int dim>
  struct AdaptedPiece
  {
    MeshPiece<dim>        piece;
    std::vector<CellPath> paths; // by cell: path to refine
  };

  /// @p whole with the cells of @p refined divided (into nine quadrilaterals, four triangles, eight tetrahedra), and
  /// transition templates between cells of different sizes. Templates are never divided themselves: where that would be
  /// necessary their parent is added to @p refined, so that angles are never worse than those of one template. All
  /// cells must be of one kind, in space tetrahedra.
  template <int dim>
  AdaptedPiece<dim> adapted(const MeshPiece<dim> &whole, std::set<CellPath> &refined);
} // namespace slipstick::mesh
