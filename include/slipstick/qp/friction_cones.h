// Coulomb friction as a feasible set: pairs of entries in plane cones |x_T| <= mu x_N, bounds on all others.
//
// The operations are those of box.h: projection, its derivative, Farkas certificate.
#pragma once

#include <slipstick/qp/box.h>

#include <vector>

namespace slipstick::qp
{
  /// One cone |x_T| <= coefficient x_N; both entries are owned by the same process.
  struct FrictionCone
  {
    std::size_t tangential;
    std::size_t normal;
    double      coefficient; // >= 0
  };

  /// Entries of cones have no bounds in the box.
  template <typename Vector>
  struct FrictionCones
  {
    Box<Vector>               box;
    std::vector<FrictionCone> cones;
  };

  enum class ConePart
  {
    inside,
    side,
    apex
  };

  /// Where the point of the cone nearest to (t, n) lies.
  inline ConePart cone_part(const double t, const double n, const double mu)
  {
    if (std::abs(t) <= mu * n)
      return ConePart::inside;
    return mu * std::abs(t) + n <= 0 ? ConePart::apex : ConePart::side;
  }

  /// (t, n) := its part along the side of the cone on which @p at lies.
  inline void project_on_side(const double at, const double mu, double &t, double &n)
  {
    const double sign = at < 0 ? -1. : 1., along = (sign * mu * t + n) / (1 + mu * mu);
    t = sign * mu * along;
    n = along;
  }

  /// x := projection of x on the set.
  template <typename Vector>
  void project(const FrictionCones<Vector> &set, Vector &x)
  {
    project(set.box, x);
    const auto xi = x.begin();
    for (const FrictionCone &cone : set.cones)
      {
        double &t = xi[cone.tangential], &n = xi[cone.normal];
        switch (cone_part(t, n, cone.coefficient))
          {
            case ConePart::inside:
              break;
            case ConePart::side:
              project_on_side(t, cone.coefficient, t, n);
              break;
            case ConePart::apex:
              t = n = 0;
              break;
          }
      }
  }

  /// p := derivative of the projection at y, times p.
  template <typename Vector>
  void multiply_derivative(const FrictionCones<Vector> &set, const Vector &y, Vector &p)
  {
    multiply_derivative(set.box, y, p);
    const auto yi = y.begin();
    const auto pi = p.begin();
    for (const FrictionCone &cone : set.cones)
      {
        double &t = pi[cone.tangential], &n = pi[cone.normal];
        switch (cone_part(yi[cone.tangential], yi[cone.normal], cone.coefficient))
          {
            case ConePart::inside:
              break;
            case ConePart::side:
              project_on_side(yi[cone.tangential], cone.coefficient, t, n);
              break;
            case ConePart::apex:
              t = n = 0;
              break;
          }
      }
  }

  template <typename Vector>
  double n_contradictions(const FrictionCones<Vector> &set)
  {
    return n_contradictions(set.box);
  }

  // A point of a cone is the sum of parts along its two sides, which are any numbers from 0: x_T = s (a - b),
  // x_N = c (a + b) with s, c the sine and cosine of half the angle between them, a in the place of x_T, b in that of x_N.

  /// Bounds of the parts along the sides of the cones; other entries keep theirs. Without friction there is one side.
  template <typename Vector>
  Box<Vector> bounds_of_sides(const FrictionCones<Vector> &set)
  {
    Box<Vector> box = set.box;
    for (const FrictionCone &cone : set.cones)
      {
        box.lower.begin()[cone.tangential] = box.lower.begin()[cone.normal] = 0;
        box.upper.begin()[cone.tangential]                                  = cone.coefficient > 0 ? infinity : 0;
        box.upper.begin()[cone.normal]                                      = infinity;
      }
    return box;
  }

  /// x := parts along the sides, of a point within the set.
  template <typename Vector>
  void resolve_into_sides(const FrictionCones<Vector> &set, Vector &x)
  {
    for (const FrictionCone &cone : set.cones)
      if (cone.coefficient > 0)
        {
          double      &t = x.begin()[cone.tangential], &n = x.begin()[cone.normal];
          const double length = std::hypot(1., cone.coefficient) / 2, over = t / cone.coefficient;
          t = length * (n + over);
          n = length * (n - over);
        }
  }

  /// x := sum of the parts along the sides, S x.
  template <typename Vector>
  void add_sides(const FrictionCones<Vector> &set, Vector &x)
  {
    for (const FrictionCone &cone : set.cones)
      {
        double      &t = x.begin()[cone.tangential], &n = x.begin()[cone.normal];
        const double c = 1 / std::hypot(1., cone.coefficient), a = t, b = n;
        t = cone.coefficient * c * (a - b);
        n = c * (a + b);
      }
  }

  /// r := S'r.
  template <typename Vector>
  void add_sides_transposed(const FrictionCones<Vector> &set, Vector &r)
  {
    for (const FrictionCone &cone : set.cones)
      {
        double      &t = r.begin()[cone.tangential], &n = r.begin()[cone.normal];
        const double c = 1 / std::hypot(1., cone.coefficient), along_t = cone.coefficient * c * t, along_n = c * n;
        t = along_n + along_t;
        n = along_n - along_t;
      }
  }

  /// See box.h; a cone is unbounded along r as far as r leaves its polar cone.
  template <typename Vector, typename Reduction>
  bool is_farkas_certificate(const FrictionCones<Vector> &set,
                             const Vector                &r,
                             const Vector                &x_e,
                             const double                 radius,
                             const double                 rounding,
                             const Reduction             &reduction)
  {
    std::array<double, 3> s  = detail::farkas_sums(set.box, r, x_e);
    const auto            ri = r.begin();
    for (const FrictionCone &cone : set.cones)
      {
        double t = ri[cone.tangential], n = ri[cone.normal];
        s[1] -= t * t + n * n; // the box took both as unbounded
        if (cone_part(t, n, cone.coefficient) == ConePart::apex)
          continue;
        if (cone_part(t, n, cone.coefficient) == ConePart::side)
          project_on_side(t, cone.coefficient, t, n);
        s[1] += t * t + n * n;
      }
    s = reduction.sum(s);
    return s[0] > std::sqrt(std::max(0., s[1])) * radius + rounding * s[2];
  }
} // namespace slipstick::qp
