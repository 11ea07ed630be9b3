// A refined piece of mesh, and the coarse cells from which its cells originate.
#pragma once

#include <slipstick/mesh/mesh_piece.h>

namespace slipstick::mesh
{
  /// Origin of a cell of a refined mesh.
  struct CellOrigin
  {
    unsigned int parent     = 0;    // cell of the coarser mesh
    unsigned int child      = 0;    // number among its children, in the order of their creation
    bool         is_regular = true; // similar to the parent, or the parent itself: not from a transition template
    bool         is_parent  = true; // it was not divided
  };

  template <int dim>
  struct RefinedPiece
  {
    MeshPiece<dim>          piece;
    std::vector<CellOrigin> origins; // by cell
  };
} // namespace slipstick::mesh
