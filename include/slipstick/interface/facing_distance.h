// Distance between two curves or surfaces that face each other.
#pragma once

#include <slipstick/mechanics/surface_facet.h>

#include <limits>
#include <optional>

namespace slipstick::interface
{
  // Curves and surfaces face each other where the scalar product of their normals is below this.
  constexpr double facing_cosine = -0.25; // 104 degrees

  /// Smallest distance of two curves or surfaces where they face each other [mm]: nodes and edge or facet midpoints of
  /// one against those of the other; curved edges are replaced by chords, quadrilaterals by two triangles. Empty if
  /// nothing faces each other or nothing is closer than @p bound.
  /// @tparam Part mechanics::BoundaryPart in 2D or in space.
  template <class Part>
  std::optional<double> facing_distance(const std::vector<Part> &a,
                                        const std::vector<Part> &b,
                                        const double             bound = std::numeric_limits<double>::max());
} // namespace slipstick::interface
