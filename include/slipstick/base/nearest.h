// Points of segments and triangles that are nearest to a given point.
#pragma once

#include <deal.II/base/point.h>

#include <algorithm>
#include <array>

namespace slipstick
{
  template <int dim>
  dealii::Point<dim> nearest_on_segment(const dealii::Point<dim> &from,
                                        const dealii::Point<dim> &to,
                                        const dealii::Point<dim> &x)
  {
    const auto along = to - from;
    return from + std::clamp((x - from) * along / along.norm_square(), 0., 1.) * along;
  }

  /// Ericson, Real-Time Collision Detection, 2005, 5.1.5.
  dealii::Point<3> nearest_on_triangle(const std::array<dealii::Point<3>, 3> &corner, const dealii::Point<3> &x);
} // namespace slipstick
