// Resultants of forces.
#pragma once

#include <array>

namespace slipstick
{
  /// Of forces in the plane.
  struct Resultant
  {
    std::array<double, 2> force{{0, 0}}; // [N]
    double                moment = 0;    // about the origin of coordinates, from x to y positive [N mm]

    template <class Place>
    void add(const double fx, const double fy, const Place &at)
    {
      force[0] += fx;
      force[1] += fy;
      moment += at[0] * fy - at[1] * fx;
    }
  };
} // namespace slipstick
