// Box constraints: projection, parts of the gradient, longest step, active entries, Farkas gap.
//
// Signs: steps are x - a g, along the negative gradient. An entry is free strictly inside its bounds; an entry with
// lower == upper is fixed: never free, without chopped gradient, without violation.
#pragma once

#include <slipstick/qp/kernels.h>

#include <limits>

namespace slipstick::qp
{
  /// lower <= x <= upper, componentwise; +-infinity: no bound.
  template <typename Vector>
  struct Box
  {
    Vector lower;
    Vector upper;
  };

  struct ActiveEntries
  {
    std::size_t lower = 0; // at the lower bound; includes fixed entries
    std::size_t upper = 0; // at the upper bound only
  };

  constexpr double infinity = std::numeric_limits<double>::infinity();

  inline double clip(const double x, const double lower, const double upper)
  {
    return std::max(lower, std::min(upper, x));
  }

  inline bool is_free(const double x, const double lower, const double upper)
  {
    return lower < x && x < upper;
  }

  /// phi_i: the gradient g_i of a free entry, otherwise 0.
  inline double free_gradient(const double x, const double g, const double lower, const double upper)
  {
    return is_free(x, lower, upper) ? g : 0.0;
  }

  /// beta_i: the part of g_i along which an active entry may leave its bound, otherwise 0.
  inline double chopped_gradient(const double x, const double g, const double lower, const double upper)
  {
    if (is_free(x, lower, upper) || !(lower < upper))
      return 0.0;
    return x <= lower ? std::min(g, 0.0) : std::max(g, 0.0);
  }

  /// gP_i = phi_i + beta_i
  inline double projected_gradient(const double x, const double g, const double lower, const double upper)
  {
    return is_free(x, lower, upper) ? g : chopped_gradient(x, g, lower, upper);
  }

  /// phi~_i: phi_i reduced such that x - step phi~ stays within the bounds.
  inline double reduced_free_gradient(const double x,
                                      const double phi,
                                      const double lower,
                                      const double upper,
                                      const double step)
  {
    if (phi > 0)
      return std::min((x - lower) / step, phi);
    return phi < 0 ? std::max((x - upper) / step, phi) : phi;
  }

  /// Longest a >= 0 such that lower <= x - a p <= upper; infinity if there is no limit.
  inline double longest_step(const double x, const double p, const double lower, const double upper)
  {
    if (p > 0)
      return (x - lower) / p;
    return p < 0 ? (x - upper) / p : infinity;
  }

  /// Parts of the gradient at one entry.
  struct GradientParts
  {
    double free    = 0; // phi
    double chopped = 0; // beta
    double reduced = 0; // phi~
    double descent = 0; // gradient for a projected step: gP for bounds, the whole gradient for curved sets
  };

  /// Calls f(i, parts) for the owned entries of x with the gradient g.
  template <typename Vector, typename F>
  void for_each_part(const Box<Vector> &box, const Vector &x, const Vector &g, const double step, const F &f)
  {
    const auto        l = box.lower.begin(), u = box.upper.begin();
    const auto        xi = x.begin(), gi = g.begin();
    const std::size_t n = local_size(x);
    for (std::size_t i = 0; i < n; ++i)
      {
        const double phi = free_gradient(xi[i], gi[i], l[i], u[i]), beta = chopped_gradient(xi[i], gi[i], l[i], u[i]);
        f(i, GradientParts{phi, beta, reduced_free_gradient(xi[i], phi, l[i], u[i], step), phi + beta});
      }
  }

  template <typename Vector>
  constexpr bool is_curved(const Box<Vector> &)
  {
    return false;
  }

  /// Number of owned entries that a step along p has moved to or beyond their bounds.
  template <typename Vector>
  std::size_t n_leaving(const Box<Vector> &box, const Vector &p, const Vector &x)
  {
    const auto        l = box.lower.begin(), u = box.upper.begin();
    const auto        xi = x.begin(), pi = p.begin();
    const std::size_t n       = local_size(x);
    std::size_t       leaving = 0;
    for (std::size_t i = 0; i < n; ++i)
      leaving += pi[i] != 0 && !is_free(xi[i], l[i], u[i]);
    return leaving;
  }

  /// x := projection of x on the box.
  template <typename Vector>
  void project(const Box<Vector> &box, Vector &x)
  {
    const auto        l = box.lower.begin(), u = box.upper.begin();
    const auto        xi = x.begin();
    const std::size_t n  = local_size(x);
    for (std::size_t i = 0; i < n; ++i)
      xi[i] = clip(xi[i], l[i], u[i]);
  }

  /// Longest a >= 0 such that x - a p stays in the box (x is in the box), over all processes.
  template <typename Vector, typename Reduction>
  double longest_step(const Box<Vector> &box, const Vector &x, const Vector &p, const Reduction &reduction)
  {
    const auto        l = box.lower.begin(), u = box.upper.begin();
    const auto        xi = x.begin(), pi = p.begin();
    const std::size_t n    = local_size(x);
    double            step = infinity;
    for (std::size_t i = 0; i < n; ++i)
      step = std::min(step, longest_step(xi[i], pi[i], l[i], u[i]));
    return reduction.min(step);
  }

  /// x := x - a p within the box, with a <= longest_step(): entries that reach a bound are set exactly to it.
  template <typename Vector>
  void step_within(const Box<Vector> &box, const double a, const Vector &p, Vector &x)
  {
    const auto        l = box.lower.begin(), u = box.upper.begin();
    const auto        xi = x.begin();
    const auto        pi = p.begin();
    const std::size_t n  = local_size(x);
    for (std::size_t i = 0; i < n; ++i)
      if (pi[i] != 0)
        {
          const bool hits = longest_step(xi[i], pi[i], l[i], u[i]) <= a;
          xi[i]           = hits ? (pi[i] > 0 ? l[i] : u[i]) : clip(xi[i] - a * pi[i], l[i], u[i]);
        }
  }

  /// Numbers of owned entries at their bounds.
  template <typename Vector>
  ActiveEntries own_active(const Box<Vector> &box, const Vector &x)
  {
    const auto        l = box.lower.begin(), u = box.upper.begin();
    const auto        xi = x.begin();
    const std::size_t n  = local_size(x);
    ActiveEntries     active;
    for (std::size_t i = 0; i < n; ++i)
      {
        active.lower += xi[i] <= l[i];
        active.upper += xi[i] >= u[i] && l[i] < u[i];
      }
    return active;
  }

  /// p := derivative of the projection at y, times p: free entries are unchanged, the others become 0.
  template <typename Vector>
  void multiply_derivative(const Box<Vector> &box, const Vector &y, Vector &p)
  {
    const auto        l = box.lower.begin(), u = box.upper.begin();
    const auto        yi = y.begin();
    const auto        pi = p.begin();
    const std::size_t n  = local_size(y);
    for (std::size_t i = 0; i < n; ++i)
      if (!is_free(yi[i], l[i], u[i]))
        pi[i] = 0;
  }

  /// Number of owned entries with lower > upper.
  template <typename Vector>
  double n_contradictions(const Box<Vector> &box)
  {
    const auto        l = box.lower.begin(), u = box.upper.begin();
    const std::size_t n     = local_size(box.lower);
    double            count = 0;
    for (std::size_t i = 0; i < n; ++i)
      count += !(l[i] <= u[i]);
    return count;
  }

  namespace detail
  {
    /// For the owned entries: r'x_e - sup r'x over the bounded entries; |r|^2 over the unbounded ones; magnitude of the
    /// summed terms.
    template <typename Vector>
    std::array<double, 3> farkas_sums(const Box<Vector> &box, const Vector &r, const Vector &x_e)
    {
      const auto            l = box.lower.begin(), u = box.upper.begin();
      const auto            ri = r.begin(), xi = x_e.begin();
      const std::size_t     n = local_size(r);
      std::array<double, 3> s{{0, 0, 0}};
      for (std::size_t i = 0; i < n; ++i)
        {
          const double bound      = ri[i] > 0 ? u[i] : l[i];
          const bool   is_bounded = std::isfinite(bound);
          const double support    = ri[i] != 0 && is_bounded ? ri[i] * bound : 0.0;
          s[0] += ri[i] * xi[i] - support;
          s[1] += is_bounded ? 0.0 : ri[i] * ri[i];
          s[2] += std::abs(ri[i] * xi[i]) + std::abs(support);
        }
      return s;
    }
  } // namespace detail

  /// Whether r, a vector in the range of Q, proves that no x with Q(x - x_e) = 0 and |x| <= radius is in the box. It
  /// does if r'x_e > max r'x over the box; unbounded entries are bounded by the radius, r'x <= |r||x|, and there is a
  /// margin for rounding: `rounding` times |r| |x_e| and |r_i l_i|, |r_i u_i|. Farkas. One reduction.
  template <typename Vector, typename Reduction>
  bool is_farkas_certificate(const Box<Vector> &box,
                             const Vector      &r,
                             const Vector      &x_e,
                             const double       radius,
                             const double       rounding,
                             const Reduction   &reduction)
  {
    const auto s = reduction.sum(detail::farkas_sums(box, r, x_e));
    return s[0] > std::sqrt(s[1]) * radius + rounding * s[2];
  }
} // namespace slipstick::qp
