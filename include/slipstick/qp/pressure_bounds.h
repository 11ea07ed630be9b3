// Bounds of tangential entries that follow normal ones.
#pragma once

#include <cmath>
#include <cstddef>
#include <vector>

namespace slipstick::qp
{
  /// |x_T| <= fixed + coefficient x_N while x_N is positive, else 0. Both entries are owned by the same process. Coulomb
  /// friction: fixed = 0; Tresca where the pair is closed: coefficient = 0.
  struct PressureBound
  {
    std::size_t tangential;
    std::size_t normal;
    double      fixed;       // >= 0
    double      coefficient; // >= 0

    double radius(const double normal_entry) const
    {
      return normal_entry > 0 ? fixed + coefficient * normal_entry : 0.;
    }
  };

  /// An entry that a face holds at a bound which moves with a free one: its increments are factor times those of `to`.
  struct Tie
  {
    std::size_t tied;
    std::size_t to;
    double      factor;
  };
} // namespace slipstick::qp
