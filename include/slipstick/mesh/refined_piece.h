// A piece of mesh that was refined, and which of its cells come from which of the coarser one.
#pragma once

#include <slipstick/mesh/mesh_piece.h>

namespace slipstick::mesh
{
  /// Where a cell of a finer mesh comes from.
  struct CellOrigin
  {
    unsigned int parent     = 0;    // cell of the coarser mesh
    unsigned int child      = 0;    // of its children, counted as they are added
    bool         is_regular = true; // of the parent's shape, or the parent itself: not made by a template between sizes
    bool         is_parent  = true; // it was left as it is
  };

  template <int dim>
  struct RefinedPiece
  {
    MeshPiece<dim>          piece;
    std::vector<CellOrigin> origins; // by cell
  };
} // namespace slipstick::mesh
