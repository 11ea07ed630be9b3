// Shape functions of degree 2 on six-node triangles and nine-node quadrilaterals.
#pragma once

#include <deal.II/base/point.h>

#include <array>

namespace slipstick::mesh
{
  /// Local coordinates are those of the unit triangle or the unit square. Nodes: the corners in cyclic order, the
  /// midpoints of the edges that start at them, the centre of a quadrilateral.
  struct FacetShapes
  {
    static constexpr unsigned int max_nodes = 9;

    using Place       = dealii::Point<2>;
    using Shape       = std::array<double, max_nodes>;
    using Derivatives = std::array<std::array<double, 2>, max_nodes>; // along both local coordinates

    /// Shape functions of degree 1 of the corners.
    static Shape linear(const unsigned int n_corners, const Place &s);

    static Shape       quadratic(const unsigned int n_corners, const Place &s);
    static Derivatives quadratic_derivatives(const unsigned int n_corners, const Place &s);

    /// Local coordinates of node i.
    static Place node(const unsigned int n_corners, const unsigned int i);

    static Place middle(const unsigned int n_corners)
    {
      const double c = n_corners == 3 ? 1. / 3 : 0.5;
      return {c, c};
    }
  };
} // namespace slipstick::mesh
