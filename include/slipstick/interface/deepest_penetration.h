// A penetration, and the deepest of several.
#pragma once

#include <deal.II/base/point.h>

#include <array>
#include <optional>

namespace slipstick::interface
{
  struct Penetration
  {
    double                depth = 0;     // [mm]
    std::array<double, 3> at{{0, 0, 0}}; // reference configuration [mm]
    double                edge = 0;      // length of the shorter of the edges there [mm]
    double                gap  = 0;      // initial gap of the node; beyond_reach only [mm]
  };

  /// Stores a penetration at @p x if it is deeper than the deepest so far.
  template <int dim>
  void take_deeper(std::optional<Penetration> &deepest,
                   const double                depth,
                   const dealii::Point<dim>   &x,
                   const double                edge,
                   const double                gap)
  {
    if (!(depth > 0 && (!deepest || depth > deepest->depth)))
      return;
    deepest = Penetration{depth, {}, edge, gap};
    for (unsigned int d = 0; d < dim; ++d)
      deepest->at[d] = x[d];
  }
} // namespace slipstick::interface
