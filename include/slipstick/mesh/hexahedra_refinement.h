// Refinement of hexahedra where it is wanted, without hanging nodes.
#pragma once

#include <slipstick/mesh/refined_piece.h>

namespace slipstick::mesh
{
  /// Divides the cells for which @p marked holds into 27, and their neighbours by templates for one marked corner, edge or face (4,
  /// 11, 22 cells). Where the marked cells bend inwards their neighbours are divided into 27, too, until no such place is left.
  /// Vertices keep their numbers.
  RefinedPiece<3> hexahedra_refined_at(const MeshPiece<3> &piece, const std::vector<bool> &marked);

  /// How many cells that makes.
  std::size_t n_hexahedra_refined_at(const MeshPiece<3> &piece, const std::vector<bool> &marked);
} // namespace slipstick::mesh
