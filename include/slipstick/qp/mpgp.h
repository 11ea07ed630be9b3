// MPGP: modified proportioning with gradient projections, for min 1/2 x'Ax - x'b within two-sided bounds.
// Dostal, Schoeberl 2005; Dostal 2009, section 5.8; expansions of Kruzik, Horak, Cermak, Pospisil, Pecha 2020.
//
// Every step lowers the objective: a gradient projection does when |A| is right (|A| grows when a Rayleigh quotient
// above it is met), a projected conjugate gradient step is replaced by the step to the boundary when that is better,
// a proportioning step along -beta is replaced by a gradient projection when it would be cut shorter than 1/|A|.
#pragma once

#include <slipstick/qp/box.h>
#include <slipstick/qp/options.h>
#include <slipstick/qp/stagnation.h>
#include <slipstick/qp/types.h>

#include <optional>
#include <type_traits>
#include <utility>

namespace slipstick::qp
{
  /// Where MPGP starts. The gradient A x - b, if known, saves a multiplication; it is used only if x is within the box.
  template <typename Vector>
  struct MpgpStart
  {
    Vector                x;
    std::optional<Vector> gradient = std::nullopt;
  };

  template <typename Vector>
  struct MpgpResult
  {
    Status status;
    Vector x;                  // within the box, exactly
    Vector gradient;           // A x - b
    double projected_gradient; // |gP|
    double norm;               // |A|: as given, or raised by what was met
    Counts counts;
  };

  /// Follows what MPGP does to x, for who keeps a linear function of x up to date; this one does nothing. v is the
  /// vector last multiplied by A.
  struct NoTracker
  {
    void stepped(double) {} // x := x - a v
    void replaced() {}      // x := v
  };

  namespace detail
  {
    template <typename Vector, typename Operator, typename Reduction, typename Tracker>
    class Mpgp
    {
    public:
      Mpgp(Operator &         A_,
           const double       norm_,
           const Vector &     b_,
           const Box<Vector> &box_,
           MpgpStart<Vector>  start,
           const MpgpOptions &options_,
           const Reduction &  reduction_,
           Tracker &          tracker_)
        : A(A_)
        , b(b_)
        , box(box_)
        , options(options_)
        , reduction(reduction_)
        , tracker(tracker_)
        , norm(norm_)
        , x(std::move(start.x))
        , gradient_is_known(start.gradient.has_value())
        , g(gradient_is_known ? std::move(*start.gradient) : b)
        , p(x)
        , Ap(x)
        , trial(x)
        , trial_g(x)
      {}

      template <typename Stop>
      MpgpResult<Vector> run(const Stop &stop)
      {
        Status status = Status::infeasible;
        if (prepare())
          status = iterate(stop);
        return {status, std::move(x), std::move(g), gradient_norm(), norm, counts};
      }

    private:
      // Squares of |phi|, |beta|, |x|, and phi~'phi, at x.
      struct Sums
      {
        double free = 0, chopped = 0, reduced = 0, x = 0;
      };

      // nullopt: go on.
      using Outcome = std::optional<Status>;

      double gradient_norm() const { return std::sqrt(sums.free + sums.chopped); }
      double step_length() const { return options.step_length / norm; }
      double noise() const { return options.rounding * (norm * std::sqrt(sums.x) + norm_b); }

      void multiply(const Vector &v, Vector &Av)
      {
        A(v, Av);
        ++counts.hessian_multiplications;
      }

      // Bring x into the box, find the gradient. False if some lower > upper, or a bound is not a number.
      bool prepare()
      {
        const auto            l = box.lower.begin(), u = box.upper.begin(), bi = b.begin();
        const auto            xi = x.begin();
        const std::size_t     n  = local_size(x);
        std::array<double, 4> s{{0, 0, 0, 0}}; // contradictions, moved entries, |b|^2, |x|^2
        for (std::size_t i = 0; i < n; ++i)
          {
            const double old = xi[i];
            s[0] += !(l[i] <= u[i]);
            xi[i] = clip(old, l[i], u[i]);
            s[1] += xi[i] != old;
            s[2] += bi[i] * bi[i];
            s[3] += xi[i] * xi[i];
          }
        s      = reduction.sum(s);
        norm_b = std::sqrt(s[2]);
        if (s[0] > 0)
          return false;
        if (!gradient_is_known || s[1] > 0)
          {
            set_zero(g); // A 0 = 0
            if (s[3] > 0)
              {
                multiply(x, g);
                tracker.replaced();
              }
            add(-1.0, b, g);
          }
        return true;
      }

      template <typename Stop>
      Status iterate(const Stop &stop)
      {
        restart();
        StagnationWatch stagnates(options.stagnation_window, options.stagnation_progress);
        for (unsigned int iteration = 0;; ++iteration)
          {
            const double gP = gradient_norm();
            if (stop(static_cast<const Vector &>(x), gP))
              return Status::converged;
            if (stagnates(gP) || gP <= noise())
              return Status::stagnated;
            if (iteration == options.max_iterations)
              return Status::iteration_limit;
            const bool is_proportional =
              sums.chopped <= options.proportioning * options.proportioning * sums.reduced;
            if (const Outcome outcome = is_proportional ? cg_step() : proportioning_step())
              return *outcome;
          }
      }

      // Split the gradient at (y, g_y).
      void add_entry(Sums &s, const double y, const double gy, const double l, const double u) const
      {
        const double phi = free_gradient(y, gy, l, u), beta = chopped_gradient(y, gy, l, u);
        s.free += phi * phi;
        s.chopped += beta * beta;
        s.reduced += phi * reduced_free_gradient(y, phi, l, u, step_length());
        s.x += y * y;
      }

      // Split the gradient at x, begin conjugate gradients anew: p = phi.
      Outcome restart()
      {
        const auto        l = box.lower.begin(), u = box.upper.begin();
        const auto        xi = x.begin(), gi = g.begin(), pi = p.begin();
        const std::size_t n = local_size(x);
        Sums              s;
        for (std::size_t i = 0; i < n; ++i)
          {
            add_entry(s, xi[i], gi[i], l[i], u[i]);
            pi[i] = free_gradient(xi[i], gi[i], l[i], u[i]);
          }
        const auto total = reduction.sum(std::array<double, 4>{{s.free, s.chopped, s.reduced, s.x}});
        sums             = {total[0], total[1], total[2], total[3]};
        return {};
      }

      // A step that would end on a bound counts as leaving: p must vanish on the active entries.
      Outcome cg_step()
      {
        multiply(p, Ap);
        const auto [pg, pAp, pp] =
          reduction.sum(std::array<double, 3>{{local_dot(p, g), local_dot(p, Ap), local_dot(p, p)}});
        if (!std::isfinite(pg) || !std::isfinite(pAp))
          return Status::stagnated;
        if (pAp <= options.smallest_curvature * norm * pp)
          return leave_flat(pg, pp);
        note_curvature(pAp, pp);
        if (pg <= 0) // rounding has spoilt the conjugacy
          return restart();
        const double a = pg / pAp;

        const auto        l = box.lower.begin(), u = box.upper.begin();
        const auto        xi = x.begin(), gi = g.begin(), pi = p.begin(), Api = Ap.begin();
        const std::size_t n       = local_size(x);
        double            leaving = 0, phi_Ap = 0;
        Sums              s;
        for (std::size_t i = 0; i < n; ++i)
          {
            const double y = xi[i] - a * pi[i], gy = gi[i] - a * Api[i];
            leaving += pi[i] != 0 && !is_free(y, l[i], u[i]);
            phi_Ap += free_gradient(y, gy, l[i], u[i]) * Api[i];
            add_entry(s, y, gy, l[i], u[i]);
          }
        const auto total =
          reduction.sum(std::array<double, 6>{{leaving, phi_Ap, s.free, s.chopped, s.reduced, s.x}});
        if (total[0] > 0)
          return expand(a, pg, pAp);

        for (std::size_t i = 0; i < n; ++i)
          {
            xi[i] -= a * pi[i];
            gi[i] -= a * Api[i];
            pi[i] = free_gradient(xi[i], gi[i], l[i], u[i]) - total[1] / pAp * pi[i];
          }
        tracker.stepped(a);
        sums = {total[2], total[3], total[4], total[5]};
        ++counts.cg_steps;
        return {};
      }

      // The conjugate gradient step x - a p would leave the box.
      Outcome expand(const double a, const double pg, const double pAp)
      {
        ++counts.expansion_steps;
        if (options.expansion == Expansion::gradient_projection)
          return gradient_projection();
        const double to_boundary = std::min(a, longest_step(box, x, p, reduction));
        if (options.expansion == Expansion::projected_cg)
          {
            evaluate_trial(a, [&](const std::size_t i) { return p.begin()[i]; });
            if (trial_change <= to_boundary * (0.5 * to_boundary * pAp - pg))
              return accept_trial();
            step(to_boundary);
            return restart();
          }
        step(to_boundary);
        const auto l = box.lower.begin(), u = box.upper.begin();
        const auto xi = x.begin(), gi = g.begin();
        evaluate_trial(step_length(), [=](const std::size_t i) { return free_gradient(xi[i], gi[i], l[i], u[i]); });
        return accept_trial();
      }

      // With A beta, unless the bounds cut the step below 1/|A|, which is no more than its optimal length.
      Outcome proportioning_step()
      {
        ++counts.proportioning_steps;
        if (options.expansion == Expansion::gradient_projection)
          return gradient_projection();
        const auto        l = box.lower.begin(), u = box.upper.begin();
        const auto        xi = x.begin(), gi = g.begin(), pi = p.begin();
        const std::size_t n = local_size(x);
        for (std::size_t i = 0; i < n; ++i)
          pi[i] = chopped_gradient(xi[i], gi[i], l[i], u[i]);
        const double longest = longest_step(box, x, p, reduction);
        if (longest * norm < 1)
          return gradient_projection();
        multiply(p, Ap);
        const double pAp = dot(p, Ap, reduction), pp = sums.chopped;
        if (!std::isfinite(pAp))
          return Status::stagnated;
        if (pAp <= options.smallest_curvature * norm * pp)
          return leave_flat(pp, pp);
        note_curvature(pAp, pp);
        step(std::min(pp / pAp, longest));
        return restart();
      }

      // x := projection of x - alpha gP
      Outcome gradient_projection()
      {
        const auto l = box.lower.begin(), u = box.upper.begin();
        const auto xi = x.begin(), gi = g.begin();
        evaluate_trial(step_length(),
                       [=](const std::size_t i) { return projected_gradient(xi[i], gi[i], l[i], u[i]); });
        return trial_distance > 0 ? accept_trial() : Outcome(Status::stagnated);
      }

      // A p = 0 up to rounding: descend as far as the bounds allow.
      Outcome leave_flat(const double pg, const double pp)
      {
        const double longest = longest_step(box, x, p, reduction);
        if (pg <= noise() * std::sqrt(pp))
          return Status::stagnated;
        if (!std::isfinite(longest))
          return Status::infeasible;
        ++counts.expansion_steps;
        step(longest);
        return restart();
      }

      // x := x - a p, a no longer than the longest step; A p is known.
      void step(const double a)
      {
        step_within(box, a, p, x);
        add(-a, Ap, g);
        tracker.stepped(a);
      }

      // trial = projection of x - length direction, its gradient, its change of the objective.
      template <typename Direction>
      void evaluate_trial(const double length, const Direction &direction)
      {
        const auto        l = box.lower.begin(), u = box.upper.begin(), bi = b.begin();
        const auto        xi = x.begin(), gi = g.begin(), yi = trial.begin(), gyi = trial_g.begin();
        const std::size_t n = local_size(x);
        for (std::size_t i = 0; i < n; ++i)
          yi[i] = clip(xi[i] - length * direction(i), l[i], u[i]);
        multiply(trial, trial_g);
        double ss = 0, sAs = 0, sg = 0; // s = trial - x
        Sums   t;
        for (std::size_t i = 0; i < n; ++i)
          {
            gyi[i] -= bi[i];
            const double s = yi[i] - xi[i];
            ss += s * s;
            sAs += s * (gyi[i] - gi[i]);
            sg += s * gi[i];
            add_entry(t, yi[i], gyi[i], l[i], u[i]);
          }
        const auto total = reduction.sum(std::array<double, 7>{{ss, sAs, sg, t.free, t.chopped, t.reduced, t.x}});
        trial_sums       = {total[3], total[4], total[5], total[6]};
        trial_distance   = std::sqrt(total[0]);
        trial_change     = total[2] + 0.5 * total[1];
        note_curvature(total[1], total[0]);
      }

      // x := trial, p = phi.
      Outcome accept_trial()
      {
        using std::swap;
        swap(x, trial);
        swap(g, trial_g);
        tracker.replaced();
        sums = trial_sums;
        const auto        l = box.lower.begin(), u = box.upper.begin();
        const auto        xi = x.begin(), gi = g.begin(), pi = p.begin();
        const std::size_t n = local_size(x);
        for (std::size_t i = 0; i < n; ++i)
          pi[i] = free_gradient(xi[i], gi[i], l[i], u[i]);
        return {};
      }

      // p'Ap = curvature, p'p = square: is |A| larger than thought?
      void note_curvature(const double curvature, const double square)
      {
        if (curvature - norm * square > noise() * std::sqrt(square))
          norm = options.norm_growth * curvature / square;
      }

      Operator &         A;
      const Vector &     b;
      const Box<Vector> &box;
      const MpgpOptions &options;
      const Reduction &  reduction;
      Tracker &          tracker;

      double norm, norm_b = 0;
      Vector x;
      bool   gradient_is_known;
      Vector g, p, Ap, trial, trial_g;
      Sums   sums, trial_sums;
      double trial_change = 0, trial_distance = 0;
      Counts counts;
    };
  } // namespace detail

  /// Minimise 1/2 x'Ax - x'b within the box until stop(x, |gP|) is true. `A(v, Av)` applies A, symmetric positive
  /// semidefinite; `norm` is |A|, best not too small; `stop` must answer alike on all processes. A start outside of the
  /// box is projected on it. From x = 0, or from a start with gradient, nothing is multiplied before the first step.
  /// status: converged if and only if stop() was true; stagnated at rounding level; infeasible if some lower > upper
  /// (x is then of no use) or if the objective is unbounded from below.
  template <typename Vector, typename Operator, typename Stop, typename Reduction, typename Tracker = NoTracker>
  MpgpResult<Vector> mpgp(Operator &&        A,
                          const double       norm,
                          const Vector &     b,
                          const Box<Vector> &box,
                          MpgpStart<Vector>  start,
                          const Stop &       stop,
                          const MpgpOptions &options,
                          const Reduction &  reduction,
                          Tracker &&         tracker = Tracker())
  {
    return detail::Mpgp<Vector, std::remove_reference_t<Operator>, Reduction, std::remove_reference_t<Tracker>>(
             A, norm, b, box, std::move(start), options, reduction, tracker)
      .run(stop);
  }
} // namespace slipstick::qp
