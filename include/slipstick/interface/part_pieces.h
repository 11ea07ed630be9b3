// Boundary parts divided into flat pieces between their nodes.
#pragma once

#include <slipstick/mechanics/surface_facet.h>

#include <array>
#include <vector>

namespace slipstick::interface
{
  /// Numbers of the nodes of a piece: a chord in the plane, a triangle in space, oriented like the part.
  template <int dim>
  using FlatPiece = std::array<unsigned int, dim>;

  const std::vector<FlatPiece<2>> &flat_pieces(const mechanics::SurfaceEdge<2> &edge);
  const std::vector<FlatPiece<3>> &flat_pieces(const mechanics::SurfaceFacet &facet);
} // namespace slipstick::interface
