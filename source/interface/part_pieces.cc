#include <slipstick/interface/part_pieces.h>

namespace slipstick::interface
{
  const std::vector<FlatPiece<2>> &flat_pieces(const mechanics::SurfaceEdge<2> &edge)
  {
    static const std::vector<FlatPiece<2>> straight{{{0, 1}}}, quadratic{{{0, 2}}, {{2, 1}}};
    return edge.n_nodes == 3 ? quadratic : straight;
  }

  const std::vector<FlatPiece<3>> &flat_pieces(const mechanics::SurfaceFacet &facet)
  {
    static const std::vector<FlatPiece<3>> triangle{{{0, 1, 2}}}, quadrilateral{{{0, 1, 2}}, {{0, 2, 3}}},
      quadratic_triangle{{{0, 3, 5}}, {{3, 1, 4}}, {{5, 4, 2}}, {{3, 4, 5}}},
      quadratic_quadrilateral{{{8, 0, 4}},
                              {{8, 4, 1}},
                              {{8, 1, 5}},
                              {{8, 5, 2}},
                              {{8, 2, 6}},
                              {{8, 6, 3}},
                              {{8, 3, 7}},
                              {{8, 7, 0}}};
    if (facet.n_corners() == 3)
      return facet.is_quadratic() ? quadratic_triangle : triangle;
    return facet.is_quadratic() ? quadratic_quadrilateral : quadrilateral;
  }
} // namespace slipstick::interface
