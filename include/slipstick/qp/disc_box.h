// Bounds on entries, and discs for pairs of entries: the operations of box.h on a set with curved parts.
//
// Dostal, Kozubek 2012, doi:10.1007/s10107-011-0454-2 (separable convex constraints). A point on its circle has no free
// gradient; its chopped gradient is the gradient without the part that points outward. Projected steps use the whole
// gradient: the multiplier of the circle slows the motion along it. Steps are assessed by the objective, which resolves
// gradients along a circle only to the square root of rounding: residuals decrease to about 1e-8 of |b|.
#pragma once

#include <slipstick/qp/box.h>

#include <vector>

namespace slipstick::qp
{
  /// Two entries, both owned, whose distance from the centre is at most the radius (positive).
  struct Disc
  {
    std::size_t           first, second;
    double                radius;
    std::array<double, 2> center{{0, 0}};
  };

  /// The entries of discs have no bounds in the box.
  template <typename Vector>
  struct DiscBox
  {
    Box<Vector>       box;
    std::vector<Disc> discs;
  };

  namespace detail
  {
    // Points inside the circle by at most this part of the radius count as on it.
    constexpr double on_circle = 1e-12;

    /// The pair of entries of a disc.
    struct Pair
    {
      double first, second;

      template <typename Vector>
      Pair(const Disc &disc, const Vector &x)
        : first(x.begin()[disc.first])
        , second(x.begin()[disc.second])
      {}
      Pair(const double first_, const double second_)
        : first(first_)
        , second(second_)
      {}

      friend Pair operator-(const Pair &a, const Pair &b)
      {
        return {a.first - b.first, a.second - b.second};
      }
      friend Pair operator*(const double c, const Pair &a)
      {
        return {c * a.first, c * a.second};
      }
      friend double dot(const Pair &a, const Pair &b)
      {
        return a.first * b.first + a.second * b.second;
      }
      double size() const
      {
        return std::hypot(first, second);
      }
      bool is_zero() const
      {
        return first == 0 && second == 0;
      }
    };

    /// Vector from the centre.
    template <typename Vector>
    Pair from_center(const Disc &disc, const Vector &x)
    {
      return Pair(disc, x) - Pair(disc.center[0], disc.center[1]);
    }

    inline bool is_on_circle(const Disc &disc, const Pair &from_center)
    {
      return from_center.size() >= (1 - on_circle) * disc.radius;
    }

    template <typename Vector>
    void put(const Disc &disc, const Pair &from_center, Vector &x)
    {
      x.begin()[disc.first]  = disc.center[0] + from_center.first;
      x.begin()[disc.second] = disc.center[1] + from_center.second;
    }

    inline Pair projected(const Disc &disc, const Pair &from_center)
    {
      const double size = from_center.size();
      return size > disc.radius ? disc.radius / size * from_center : from_center;
    }

    /// Longest a >= 0 with |at - a p| at most the radius.
    inline double longest_step(const Disc &disc, const Pair &at, const Pair &p)
    {
      if (p.is_zero())
        return infinity;
      const double a = dot(p, p), b = dot(p, at), c = std::max(0., disc.radius * disc.radius - dot(at, at));
      const double root = std::sqrt(b * b + a * c);
      return b >= 0 ? (b + root) / a : c / (root - b);
    }
  } // namespace detail

  template <typename Vector>
  constexpr bool is_curved(const DiscBox<Vector> &)
  {
    return true;
  }

  template <typename Vector>
  double n_contradictions(const DiscBox<Vector> &set)
  {
    return n_contradictions(set.box);
  }

  template <typename Vector, typename F>
  void for_each_part(const DiscBox<Vector> &set, const Vector &x, const Vector &g, const double step, const F &f)
  {
    std::vector<char> is_of_disc(local_size(x), 0);
    for (const Disc &disc : set.discs)
      is_of_disc[disc.first] = is_of_disc[disc.second] = 1;
    for_each_part(set.box, x, g, step, [&](const std::size_t i, const GradientParts &parts) {
      if (!is_of_disc[i])
        f(i, parts);
    });
    for (const Disc &disc : set.discs)
      {
        const detail::Pair at = detail::from_center(disc, x), gradient(disc, g);
        GradientParts      first{0, 0, 0, gradient.first}, second{0, 0, 0, gradient.second};
        if (detail::is_on_circle(disc, at))
          {
            const detail::Pair normal = 1 / at.size() * at;
            const detail::Pair left   = gradient - std::min(0., dot(gradient, normal)) * normal;
            first.chopped             = left.first;
            second.chopped            = left.second;
          }
        else
          {
            const detail::Pair reduced = 1 / step * (at - detail::projected(disc, at - step * gradient));
            first.free                 = gradient.first;
            second.free                = gradient.second;
            first.reduced              = reduced.first;
            second.reduced             = reduced.second;
          }
        f(disc.first, first);
        f(disc.second, second);
      }
  }

  template <typename Vector>
  std::size_t n_leaving(const DiscBox<Vector> &set, const Vector &p, const Vector &x)
  {
    std::size_t leaving = n_leaving(set.box, p, x);
    for (const Disc &disc : set.discs)
      leaving += !detail::Pair(disc, p).is_zero() && detail::is_on_circle(disc, detail::from_center(disc, x));
    return leaving;
  }

  template <typename Vector>
  void project(const DiscBox<Vector> &set, Vector &x)
  {
    project(set.box, x);
    for (const Disc &disc : set.discs)
      detail::put(disc, detail::projected(disc, detail::from_center(disc, x)), x);
  }

  template <typename Vector, typename Reduction>
  double longest_step(const DiscBox<Vector> &set, const Vector &x, const Vector &p, const Reduction &reduction)
  {
    double step = infinity;
    for (const Disc &disc : set.discs)
      step = std::min(step, detail::longest_step(disc, detail::from_center(disc, x), detail::Pair(disc, p)));
    return reduction.min(std::min(step, longest_step(set.box, x, p, reduction)));
  }

  template <typename Vector>
  void step_within(const DiscBox<Vector> &set, const double a, const Vector &p, Vector &x)
  {
    std::vector<detail::Pair> ends;
    for (const Disc &disc : set.discs)
      {
        const detail::Pair at  = detail::from_center(disc, x), along(disc, p);
        detail::Pair       end = detail::projected(disc, at - a * along);
        if (detail::longest_step(disc, at, along) <= a)
          end = disc.radius / end.size() * end;
        ends.push_back(end);
      }
    step_within(set.box, a, p, x);
    for (std::size_t k = 0; k < set.discs.size(); ++k)
      if (!detail::Pair(set.discs[k], p).is_zero())
        detail::put(set.discs[k], ends[k], x);
  }

  /// Numbers of active owned entries; both entries of a node on its circle count as active at the upper bound.
  template <typename Vector>
  ActiveEntries own_active(const DiscBox<Vector> &set, const Vector &x)
  {
    ActiveEntries active = own_active(set.box, x);
    for (const Disc &disc : set.discs)
      active.upper += detail::is_on_circle(disc, detail::from_center(disc, x)) ? 2 : 0;
    return active;
  }

  /// See box.h.
  template <typename Vector, typename Reduction>
  bool is_farkas_certificate(const DiscBox<Vector> &set,
                             const Vector          &r,
                             const Vector          &x_e,
                             const double           radius,
                             const double           rounding,
                             const Reduction       &reduction)
  {
    std::array<double, 3> s = detail::farkas_sums(set.box, r, x_e);
    for (const Disc &disc : set.discs)
      {
        const detail::Pair along(disc, r);
        const double       of_center = disc.center[0] * along.first + disc.center[1] * along.second;
        const double       support   = of_center + disc.radius * along.size();
        s[0] -= support;
        s[1] -= dot(along, along); // farkas_sums() treated both entries as unbounded
        s[2] += std::abs(of_center) + disc.radius * along.size();
      }
    s = reduction.sum(s);
    return s[0] > std::sqrt(std::max(0., s[1])) * radius + rounding * s[2];
  }
} // namespace slipstick::qp
