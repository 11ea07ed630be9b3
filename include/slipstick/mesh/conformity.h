// Check that cells form a conforming mesh: no overlapping cells, no node inside an edge, no coincident nodes.
#pragma once

#include <slipstick/mesh/mesh_piece.h>

#include <optional>

namespace slipstick::mesh
{
  /// A fault that prevents cells from being a conforming mesh, and its place.
  template <int dim>
  struct ConformityFault
  {
    enum class Kind
    {
      overlap,      // two overlapping cells
      hanging_node, // a vertex inside an edge (in space also a face) of another cell
      twin_nodes    // two vertices at the same place
    };

    Kind               kind;
    dealii::Point<dim> place;
    unsigned int       first_cell, second_cell;
  };

  /// The first fault of a piece whose cells are all right-handed, with no more than two cells per face. In the plane
  /// the number of cells that cover a point is the winding number of the outline around it; therefore only the edges of
  /// the outline are examined: none may lie on, cross or touch another, and none may have cells on both sides. In space
  /// coincident nodes of the outline and nodes inside faces of the outline are found. The two flanks of a slit may
  /// coincide if all their faces have names (an id other than 0).
  template <int dim>
  std::optional<ConformityFault<dim>> find_fault(const MeshPiece<dim> &piece);
} // namespace slipstick::mesh
