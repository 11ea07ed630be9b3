// Cuts a mesh by METIS.
#pragma once

#include <slipstick/mesh/mesh_piece.h>

namespace slipstick::mesh
{
  /// METIS partition of the cells of @p piece, which must be connected through faces, into compact parts. METIS cuts as
  /// few links between cells as possible, counted by weight: faces by their size relative to the other faces of their
  /// cells, so that flat cells do not give flat parts; in space also edges, so that oblique interfaces count roughly by
  /// their area (counted by faces alone, a staircase is as large as the sides of the box around it;
  /// doc/decisions/0122).
  /// @return a part number for every cell.
  template <int dim>
  std::vector<unsigned int> metis_parts(const MeshPiece<dim> &piece,
                                        const unsigned int    n_parts,
                                        const unsigned int    seed = 0);
} // namespace slipstick::mesh
