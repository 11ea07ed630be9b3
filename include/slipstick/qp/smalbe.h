// SMALBE-M: semimonotonic augmented Lagrangians for bounds and equalities, with MPGP as the inner solver.
// Dostal, Horak 2004; Dostal 2009, sections 8.1-8.9; Dostal et al. 2010, doi:10.1016/j.cam.2010.05.042. With discs
// (friction in space) it is SMALSE-M: Dostal, Kozubek, Markopoulos, Brzobohaty, Vondrak, Horyl 2012.
#pragma once

#include <slipstick/qp/augmented_operator.h>
#include <slipstick/qp/mpgp.h>

#include <algorithm>
#include <cstdint>
#include <functional>

namespace slipstick::qp
{
  /// Start of SMALBE. shift = G'mu, the multiplier of the equalities in the range of G', if known.
  template <typename Vector>
  struct SmalbeStart
  {
    Vector                x;
    std::optional<Vector> shift = std::nullopt;
  };

  template <typename Vector>
  struct SmalbeResult
  {
    Status status;
    Vector x;                  // exactly in the box
    Vector gradient;           // (P F P + rho Q) x - b + shift
    Vector shift;              // G'mu
    double projected_gradient; // |gP| over the reference of the goal
    double equality_residual;  // |PFP| |Gx| over the reference of the goal
    double reference;          // reference value of the residuals
    double penalty;            // rho
    Counts counts;
  };

  namespace detail
  {
    // An error |G x| above this part of the forces that balance the loads is too large, whatever the goal ...
    constexpr double gross_imbalance = 0.01;
    // ... unless these forces are less than this part of all forces.
    constexpr double negligible_forces = 1e-9;

    template <typename Vector, typename Problem, typename Set>
    class Smalbe
    {
    public:
      Smalbe(const Problem                                             &problem_,
             const double                                               norm_,
             const Vector                                              &b,
             const Set                                                 &set_,
             SmalbeStart<Vector>                                        start,
             const Goal                                                &goal,
             const SmalbeOptions                                       &options_,
             const Observer                                            &observer_,
             const std::function<bool(const Vector &, const Vector &)> &accepts_)
        : problem(problem_)
        , reduction(problem.reduction())
        , norm(norm_)
        , rho(options_.regularization * norm_)
        , set(set_)
        , options(options_)
        , observer(observer_)
        , accepts(accepts_)
        , A(problem, rho, b)
        , x(std::move(start.x))
        , shift(start.shift ? std::move(*start.shift) : zero_like(b))
        , rhs(b)
        , inner_norm(std::max(norm, rho))
        , M(options_.initial_balance)
      {
        project(set, x);
        add(-1.0, shift, rhs);
        const auto s = reduction.sum(std::array<double, 2>{{local_dot(b, b), local_dot(x, x)}});
        reference    = goal.reference;
        if (!(reference > 0))
          reference = s[0] > 0 ? std::sqrt(s[0]) : s[1] > 0 ? norm * std::sqrt(s[1]) : norm;
        target      = goal.tolerance * reference;
        feasible    = target;
        goal_forces = goal.forces;
      }

      SmalbeResult<Vector> run()
      {
        const Status status = iterate();
        return {status,
                std::move(x),
                std::move(*g),
                std::move(shift),
                gP / reference,
                feasibility / reference,
                reference,
                rho,
                counts};
      }

    private:
      Status iterate()
      {
        StagnationWatch stagnates(options.stagnation_window, options.stagnation_progress);
        StagnationWatch feasibility_stagnates(options.penalty_window, options.penalty_progress);
        for (;;)
          {
            const Status inner = minimise();
            measure();
            if (inner == Status::infeasible)
              return inner;
            if (gP <= target && feasibility <= feasible)
              return Status::converged;
            if (accepts && accepts(x, *g))
              return Status::converged;
            if (inner == Status::iteration_limit || counts.outer_iterations >= options.max_outer_iterations ||
                counts.hessian_multiplications >= options.max_multiplications)
              return Status::iteration_limit;
            if (inner == Status::stagnated && feasibility <= std::max(feasible, noise))
              return Status::stagnated;
            const bool gives_up = stagnates(std::max(gP, feasibility));
            const bool is_slow  = feasibility_stagnates(feasibility) && feasibility > feasible;
            if ((gives_up || is_slow) && is_contradictory())
              return Status::infeasible;
            if (gives_up)
              return Status::stagnated;
            update_multiplier(inner == Status::converged);
            if (is_slow)
              {
                raise_penalty();
                feasibility_stagnates = StagnationWatch(options.penalty_window, options.penalty_progress);
              }
          }
      }

      // MPGP on the augmented Lagrangian of the current multiplier.
      Status minimise()
      {
        const auto stop = [this](const Vector &, const double gradient) {
          if (gradient > reference)
            return false;
          const double residual = norm * qp::norm(A.range_part(), reduction);
          const double balanced = std::min(M * residual, reference);
          return gradient <= (residual <= feasible ? std::max(balanced, target) : balanced);
        };
        MpgpOptions how = options.inner; // an iteration takes one or two multiplications
        how.max_iterations =
          std::min<std::uint64_t>(how.max_iterations, options.max_multiplications - counts.hessian_multiplications);
        auto inner =
          mpgp(A, inner_norm, rhs, set, MpgpStart<Vector>{std::move(x), std::move(g)}, stop, how, reduction, A);
        x          = std::move(inner.x);
        g          = std::move(inner.gradient);
        inner_norm = inner.norm;
        counts += inner.counts;
        ++counts.outer_iterations;
        return inner.status;
      }

      // Residuals, augmented Lagrangian, active entries at x: one reduction, one projection.
      void measure()
      {
        const Vector         &Qx = A.range_part(x);
        const auto            q  = Qx.begin();
        const auto            xi = x.begin(), gi = g->begin(), ri = rhs.begin();
        const auto            active = own_active(set, x);
        std::array<double, 6> s{{0, 0, 0, double(active.lower), double(active.upper), 0}};
        for_each_part(set, x, *g, 1., [&](const std::size_t i, const GradientParts &parts) {
          const double gp = parts.free + parts.chopped;
          s[0] += gp * gp;
          s[1] += q[i] * q[i];
          s[2] += 0.5 * xi[i] * (gi[i] - ri[i]);
          s[5] += xi[i] * xi[i];
        });
        s           = reduction.sum(s);
        gP          = std::sqrt(s[0]);
        Gx          = std::sqrt(s[1]);
        feasibility = norm * Gx;
        lagrangian  = s[2];
        noise       = options.inner.rounding * norm * std::sqrt(s[5]);
        // if gaps determine the reference, forces may be negligible compared with it
        feasible =
          std::min(target, gross_imbalance * norm * std::max(goal_forces, negligible_forces * std::sqrt(s[5])));
        if (observer)
          observer({counts.outer_iterations,
                    counts.hessian_multiplications,
                    gP / reference,
                    feasibility / reference,
                    static_cast<std::size_t>(s[3]),
                    static_cast<std::size_t>(s[4])});
      }

      // mu += rho G x; the gradient is updated without a multiplication. M is reduced unless the Lagrangian has
      // increased enough.
      void update_multiplier(const bool may_balance)
      {
        if (may_balance && lagrangian_before && lagrangian < *lagrangian_before + 0.5 * rho * Gx * Gx)
          M /= options.balance_reduction;
        lagrangian_before = lagrangian;
        add(rho, A.range_part(), shift);
        add(rho, A.range_part(), *g);
        add(-rho, A.range_part(), rhs);
      }

      // rho is too small for the bounds: in a small box |Gx| is small although mu is far from its solution.
      void raise_penalty()
      {
        const double raise = (options.penalty_growth - 1) * rho;
        add(raise, A.range_part(), *g);
        rho += raise;
        A.set_penalty(rho);
        inner_norm = std::max(inner_norm, rho);
        lagrangian_before.reset();
      }

      // Whether -Qx proves that no point of the box has Q x = 0.
      bool is_contradictory() const
      {
        Vector r = zero_like(x);
        add(-1.0, A.range_part(), r);
        const double radius = options.certificate_radius * qp::norm(x, reduction);
        return is_farkas_certificate(set, r, zero_like(x), radius, options.inner.rounding, reduction);
      }

      const Problem                                        &problem;
      decltype(std::declval<const Problem &>().reduction()) reduction;

      const double         norm;
      double               rho;
      const Set           &set;
      const SmalbeOptions &options;
      const Observer      &observer;

      const std::function<bool(const Vector &, const Vector &)> &accepts;

      AugmentedOperator<Vector, Problem> A;

      Vector                x;
      std::optional<Vector> g;
      Vector                shift, rhs; // rhs = b - shift
      double                inner_norm, M;
      double                reference = 0, target = 0;     // of residuals
      double                feasible = 0, goal_forces = 0; // of |PFP| |G x|; forces that balance the loads
      double                gP = 0, Gx = 0, feasibility = 0, lagrangian = 0, noise = 0;
      std::optional<double> lagrangian_before;
      Counts                counts;
    };
  } // namespace detail

  /// Minimises 1/2 x'PFPx - x'b, b in the range of P, over the set (Box or DiscBox) and Q x = 0, until |gP| and |PFP|
  /// |Gx| are at most goal.tolerance times goal.reference (default |b|; if that is 0, |PFP| times |start|). `norm` is
  /// |PFP|. A start outside the box is projected onto it; from 0 there is no multiplication before the first step. The
  /// observer is called after every outer step, on every process; so is @p accepts, with x and the gradient, which may
  /// end the solve before the goal is reached (it must return the same on every process).
  /// status: infeasible if the bounds contradict each other (x is then meaningless) or the equalities (with proof;
  /// without proof the status is stagnated), or if the objective is unbounded from below.
  /// @code
  /// using Vector = std::vector<double>;
  /// struct Problem // F = diag(1, 3), G = (1, 1) / sqrt(2)
  /// {
  ///   void multiply(const Vector &x, Vector &y) const { y = {x[0], 3 * x[1]}; }
  ///   void project_range(const Vector &x, Vector &y) const { y.assign(2, (x[0] + x[1]) / 2); }
  ///   SerialReduction reduction() const { return {}; }
  /// };
  /// const Box<Vector> box{{-1, -1}, {0.25, 1}};
  /// const auto        best = smalbe(Problem(), 2., Vector{1, -1}, box, {Vector(2, 0.)}, 1e-10);
  /// assert(best.status == Status::converged);
  /// assert(std::abs(best.x[0] - 0.25) < 1e-9 && std::abs(best.x[1] + 0.25) < 1e-9); // 0.5, -0.5 without the box
  /// @endcode
  template <typename Vector, typename Problem, typename Set>
  SmalbeResult<Vector> smalbe(const Problem                                                      &problem,
                              const double                                                        norm,
                              const Vector                                                       &b,
                              const Set                                                          &set,
                              SmalbeStart<Vector>                                                 start,
                              const Goal                                                         &goal,
                              const SmalbeOptions                                                &options  = {},
                              const Observer                                                     &observer = {},
                              const std::function<bool(const Vector &x, const Vector &gradient)> &accepts  = {})
  {
    return detail::Smalbe<Vector, Problem, Set>(problem,
                                                norm,
                                                b,
                                                set,
                                                std::move(start),
                                                goal,
                                                options,
                                                observer,
                                                accepts)
      .run();
  }
} // namespace slipstick::qp
