// Whether cells form a conforming mesh: no overlapping cells, no node inside an edge, no coincident nodes.
#pragma once

#include <slipstick/mesh/mesh_piece.h>

#include <optional>

namespace slipstick::mesh
{
  /// What keeps cells from being a mesh, and where.
  template <int dim>
  struct ConformityFault
  {
    enum class Kind
    {
      overlap,      // two cells on top of each other
      hanging_node, // a vertex inside of an edge, in space also a face, of another cell
      twin_nodes    // two vertices at one place
    };

    Kind               kind;
    dealii::Point<dim> place;
    unsigned int       first_cell, second_cell;
  };

  /// The first fault of a piece whose cells are all right-handed, with no more than two at a face. In the plane, as the
  /// number of cells above a point is the winding number of the outline around it, only the edges of the outline are
  /// examined: none may lie on, cross or touch another, and none may have a cell on both sides. In space nodes of the
  /// outline at one place or inside faces of the outline are found. The two flanks of a slit may lie on each other where all their faces have names
  /// (an id other than 0).
  template <int dim>
  std::optional<ConformityFault<dim>> find_fault(const MeshPiece<dim> &piece);
} // namespace slipstick::mesh
