// The admissible forces of a contact law at one node: the only form in which friction enters the solvers.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace slipstick::qp
{
  /// Normal force n >= 0 (compression positive), tangential force in a disc (in the plane: an interval) whose radius
  /// follows n: |t| <= min(fixed + coefficient n, cap) if n is positive, otherwise 0. No friction: all zero; Tresca on
  /// closed contact: only `fixed`; Coulomb: only `coefficient`. All functions except radius() refer to the closure, in
  /// which the radius at n = 0 is `fixed` (at most `cap`): a convex polygon. As the disc is rotationally symmetric, t
  /// may be the magnitude of a tangential force wherever its sign does not matter.
  struct NodeSet
  {
    double fixed       = 0;        // >= 0
    double coefficient = 0;        // >= 0
    double cap         = HUGE_VAL; // >= 0

    double closed_radius(const double n) const
    {
      return std::min(fixed + coefficient * std::max(n, 0.), cap);
    }

    double radius(const double n) const
    {
      return n > 0 ? closed_radius(n) : 0.;
    }

    /// Derivative of the radius with respect to n where it has this value; it ties a slipping force to the normal
    /// force.
    double slope(const double radius) const
    {
      return radius < cap ? coefficient : 0.;
    }

    /// The part of the boundary nearest to (t, n): two edges meet at the foot (n = 0) and at the corner, where the cap
    /// is reached. A foot of zero width is the apex of a cone.
    enum class Part
    {
      inside,
      base, // n = 0
      foot,
      side, // |t| = fixed + coefficient n
      corner,
      top // |t| = cap
    };

    Part part(const double t, const double n) const
    {
      const double size = std::abs(t), width = std::min(fixed, cap);
      if (n >= 0 && size <= closed_radius(n))
        return Part::inside;
      if (n < 0 && size < width)
        return Part::base;
      const double along = coefficient * (size - width) + n; // position along the side, measured from the foot
      if (along <= 0)
        return Part::foot;
      const double height = corner_height();
      if (n >= height)
        return Part::top;
      return along < (1 + coefficient * coefficient) * height ? Part::side : Part::corner;
    }

    /// (t, n) := nearest point of the closure.
    void project(double &t, double &n) const
    {
      const double at = t;
      const auto   to = [&](const double size, const double normal) {
        t = at < 0 ? -size : size;
        n = normal;
      };
      const double width = std::min(fixed, cap);
      switch (part(t, n))
        {
          case Part::inside:
            break;
          case Part::base:
            n = 0;
            break;
          case Part::foot:
            to(width, 0);
            break;
          case Part::side:
            n = (coefficient * (std::abs(t) - width) + n) / (1 + coefficient * coefficient);
            to(width + coefficient * n, n);
            break;
          case Part::corner:
            to(cap, corner_height());
            break;
          case Part::top:
            to(cap, n);
            break;
        }
    }

    /// (dt, dn) := derivative of the projection at (t, n), times (dt, dn): the identity inside, zero at corners, a
    /// projection along the side.
    void multiply_derivative(const double t, const double n, double &dt, double &dn) const
    {
      const Part at = part(t, n);
      if (at == Part::side)
        {
          const double slope = t < 0 ? -coefficient : coefficient, along = (slope * dt + dn) / (1 + slope * slope);
          dt = slope * along;
          dn = along;
          return;
        }
      if (at != Part::inside && at != Part::base)
        dt = 0;
      if (at != Part::inside && at != Part::top)
        dn = 0;
    }

    /// Support function of the closure, as far as it is finite: the part of (t, n) along which the set is unbounded,
    /// i.e. its projection onto the recession cone, is subtracted from (t, n) first.
    struct Support
    {
      double value;     // maximum scalar product of the remainder with a point of the set
      double unbounded; // squared length of the subtracted part
    };

    Support support(const double t, const double n) const
    {
      double     along_t = t, along_n = n;
      const bool is_capped = std::isfinite(cap) || coefficient == 0;
      if (is_capped)
        {
          along_t = 0;
          along_n = std::max(n, 0.);
        }
      else
        NodeSet{0, coefficient}.project(along_t, along_n);
      const double size = std::abs(t - along_t), rest = n - along_n, width = std::min(fixed, cap);
      const bool   has_corner = is_capped && coefficient > 0 && width < cap;
      return {has_corner ? std::max(width * size, cap * size + corner_height() * rest) : width * size,
              along_t * along_t + along_n * along_n};
    }

  private:
    // Normal force at which the cap is reached.
    double corner_height() const
    {
      return fixed >= cap ? 0. : coefficient > 0 ? (cap - fixed) / coefficient : HUGE_VAL;
    }
  };
} // namespace slipstick::qp
