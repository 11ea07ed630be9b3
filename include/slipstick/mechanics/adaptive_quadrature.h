// Integrals of formulas over an edge; pieces of the edge are bisected until two successive integrals agree.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>

namespace slipstick::mechanics
{
  // Initial number of pieces of an edge: features narrower than about a fiftieth of it may be missed.
  constexpr unsigned int n_first_pieces = 16;
  // A piece and its two halves agree if they differ by at most this fraction of the integral of the magnitudes.
  constexpr double same_integral = 1e-12;
  // Maximum number of bisections of a piece: a jump is then located to rounding.
  constexpr unsigned int max_halvings = 44;
  // Limit on the number of pieces per edge; only formulas that are not integrable or oscillate indefinitely need more.
  constexpr unsigned int max_pieces = 20000;

  /// n functions of s in [0, 1], evaluated together.
  template <std::size_t n>
  class AdaptiveQuadrature
  {
  public:
    using Values = std::array<double, n>;

    /// @param f f(s), Values.
    template <class F>
    explicit AdaptiveQuadrature(const F &f)
    {
      std::array<Values, n_first_pieces> first;
      double                             scale = 0;
      for (unsigned int k = 0; k < n_first_pieces; ++k)
        {
          first[k] = gauss(f, place(k), place(k + 1));
          scale += magnitude;
        }
      for (unsigned int k = 0; k < n_first_pieces; ++k)
        refine(f, place(k), place(k + 1), first[k], same_integral * scale, 0);
    }

    Values integral{};
    bool   is_resolved = true;

  private:
    static double place(const unsigned int k)
    {
      return double(k) / n_first_pieces;
    }

    /// Five points; sets the magnitude.
    template <class F>
    Values gauss(const F &f, const double from, const double to)
    {
      const double a = std::sqrt(5 - 2 * std::sqrt(10. / 7)) / 3, b = std::sqrt(5 + 2 * std::sqrt(10. / 7)) / 3;
      const double w = (322 + 13 * std::sqrt(70.)) / 1800, v = (322 - 13 * std::sqrt(70.)) / 1800;
      const std::array<double, 5> points{{-b, -a, 0, a, b}}, weights{{v, w, 64. / 225, w, v}};
      Values                      sum{};
      magnitude = 0;
      for (unsigned int q = 0; q < 5; ++q)
        {
          const Values at = f(from + (to - from) * (0.5 + 0.5 * points[q]));
          for (unsigned int i = 0; i < n; ++i)
            {
              sum[i] += (to - from) * weights[q] * at[i];
              magnitude += (to - from) * weights[q] * std::abs(at[i]);
            }
        }
      ++n_pieces;
      return sum;
    }

    template <class F>
    void refine(const F           &f,
                const double       from,
                const double       to,
                const Values      &whole,
                const double       tolerance,
                const unsigned int halvings)
    {
      const double middle = 0.5 * (from + to);
      const Values left = gauss(f, from, middle), right = gauss(f, middle, to);
      double       difference = 0;
      for (unsigned int i = 0; i < n; ++i)
        difference = std::max(difference, std::abs(left[i] + right[i] - whole[i]));
      const bool is_same = difference <= tolerance;
      if (is_same || halvings == max_halvings || n_pieces > max_pieces)
        {
          is_resolved = is_resolved && (is_same || halvings == max_halvings);
          for (unsigned int i = 0; i < n; ++i)
            integral[i] += left[i] + right[i];
          return;
        }
      refine(f, from, middle, left, tolerance, halvings + 1);
      refine(f, middle, to, right, tolerance, halvings + 1);
    }

    double       magnitude = 0;
    unsigned int n_pieces  = 0;
  };
} // namespace slipstick::mechanics
