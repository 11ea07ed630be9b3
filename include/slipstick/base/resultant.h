// Resultants of forces.
#pragma once

#include <array>

namespace slipstick
{
  /// Resultant of forces in the plane (z and all moments except that about z are 0) or in space.
  struct Resultant
  {
    std::array<double, 3> force{{0, 0, 0}};  // [N]
    std::array<double, 3> moment{{0, 0, 0}}; // about the origin, positive from x to y about z [N mm]

    /// Adds a force at a place, both with @p dim components.
    template <int dim, class Force, class Place>
    void add(const Force &f, const Place &at)
    {
      for (unsigned int d = 0; d < dim; ++d)
        force[d] += f[d];
      moment[2] += at[0] * f[1] - at[1] * f[0];
      if constexpr (dim == 3)
        {
          moment[0] += at[1] * f[2] - at[2] * f[1];
          moment[1] += at[2] * f[0] - at[0] * f[2];
        }
    }

    Resultant &operator+=(const Resultant &other)
    {
      for (unsigned int d = 0; d < 3; ++d)
        {
          force[d] += other.force[d];
          moment[d] += other.moment[d];
        }
      return *this;
    }

    /// All components, for sums over ranks.
    static constexpr unsigned int n_numbers = 6;
    std::array<double, n_numbers> numbers() const
    {
      return {{force[0], force[1], force[2], moment[0], moment[1], moment[2]}};
    }
    static Resultant of(const double *n)
    {
      return {{{n[0], n[1], n[2]}}, {{n[3], n[4], n[5]}}};
    }
  };
} // namespace slipstick
