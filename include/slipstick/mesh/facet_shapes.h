// Shape functions of degree 2 on triangles with six nodes and quadrilaterals with nine.
#pragma once

#include <deal.II/base/point.h>

#include <array>

namespace slipstick::mesh
{
  /// Local coordinates are those of the unit triangle or the unit square. Corners run around and come first; then the middles of
  /// the edges that begin at them, then that of a quadrilateral.
  struct FacetShapes
  {
    static constexpr unsigned int max_nodes = 9;

    using Place       = dealii::Point<2>;
    using Shape       = std::array<double, max_nodes>;
    using Derivatives = std::array<std::array<double, 2>, max_nodes>; // along both local coordinates

    /// Those of degree 1 of the corners.
    static Shape linear(const unsigned int n_corners, const Place &s);

    static Shape       quadratic(const unsigned int n_corners, const Place &s);
    static Derivatives quadratic_derivatives(const unsigned int n_corners, const Place &s);

    /// Where node i is.
    static Place node(const unsigned int n_corners, const unsigned int i);

    static Place middle(const unsigned int n_corners)
    {
      const double c = n_corners == 3 ? 1. / 3 : 0.5;
      return {c, c};
    }
  };
} // namespace slipstick::mesh
