// Refinement of single cells, conforming, from mesh to mesh without loss of shape.
#pragma once

#include <slipstick/mesh/mesh_piece.h>

#include <cstdint>
#include <map>
#include <set>
#include <utility>
#include <vector>

namespace slipstick::mesh
{
  /// A cell that came from one of the mesh as the scene has it by division in cells of its own shape alone: the number of
  /// that, then of each child. Independent of what is refined elsewhere.
  using CellPath = std::vector<std::uint32_t>;

  /// Cells by their global vertices, sorted; no_vertex is the last of a triangle. Solids are tetrahedra here.
  using CellKey = std::array<GlobalVertex, 4>;

  /// The key of a cell with the global vertices @p vertices.
  CellKey cell_key(std::vector<GlobalVertex> vertices);

  /// Which cells of the bodies are refined beyond what the scene says. Kept by rank 0, empty on the others.
  struct Refinement
  {
    std::vector<std::set<CellPath>> refined; // by body

    /// Of the mesh that was made last: body of a cell, and what to put into `refined` to make the cells there smaller.
    std::map<CellKey, std::pair<unsigned int, CellPath>> cells;
  };

  template <int dim>
  struct AdaptedPiece
  {
    MeshPiece<dim>        piece;
    std::vector<CellPath> paths; // by cell: what to refine to make it smaller
  };

  /// @p whole with the cells of @p refined divided (nine quadrilaterals, four triangles, eight tetrahedra), all others as templates between
  /// cells of different sizes want it. Templates are never divided themselves: where that would be needed their parent is
  /// added to @p refined, so that angles stay those of one template. Cells must be of one kind, solids tetrahedra.
  template <int dim>
  AdaptedPiece<dim> adapted(const MeshPiece<dim> &whole, std::set<CellPath> &refined);
} // namespace slipstick::mesh
