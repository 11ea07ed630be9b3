// Local refinement of hexahedra without hanging nodes.
#pragma once

#include <slipstick/mesh/refined_piece.h>

namespace slipstick::mesh
{
  /// Divides the cells for which @p marked holds into 27, and their neighbours by templates for one marked corner, edge
  /// or face (4, 11, 22 cells). Where the marked region is concave, neighbouring cells are also divided into 27 until
  /// it is not.
  /// Vertices keep their numbers.
  RefinedPiece<3> hexahedra_refined_at(const MeshPiece<3> &piece, const std::vector<bool> &marked);

  /// Number of cells after this refinement.
  std::size_t n_hexahedra_refined_at(const MeshPiece<3> &piece, const std::vector<bool> &marked);
} // namespace slipstick::mesh
