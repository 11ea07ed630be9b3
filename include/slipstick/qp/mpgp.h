// MPGP: modified proportioning with gradient projections, for min 1/2 x'Ax - x'b within two-sided bounds and discs.
// Dostal, Schoeberl 2005; Dostal 2009, section 5.8; expansions of Kruzik, Horak, Cermak, Pospisil, Pecha 2020.
//
// Every step decreases the objective: a projected step that does not is shortened; |A| is increased if a larger
// Rayleigh quotient occurs; a proportioning step along -beta is replaced by a gradient projection if the bounds would
// shorten it below 1/|A|. None of this needs a multiplication.
#pragma once

#include <slipstick/qp/mpgp_iterate.h>
#include <slipstick/qp/stagnation.h>

#include <type_traits>

namespace slipstick::qp
{
  template <typename Vector>
  struct MpgpResult
  {
    Status status;
    Vector x;                  // exactly in the box
    Vector gradient;           // A x - b
    double projected_gradient; // |gP|
    double norm;               // |A|: as given, or increased during the iteration
    Counts counts;
  };

  namespace detail
  {
    /// The choice of steps of MPGP.
    template <typename Iterate>
    class Mpgp
    {
    public:
      Mpgp(Iterate &iterate_, const MpgpOptions &options_)
        : iterate(iterate_)
        , options(options_)
      {}

      template <typename Stop>
      Status run(const Stop &stop)
      {
        if (!iterate.prepare())
          return Status::infeasible;
        StagnationWatch stagnates(options.stagnation_window, options.stagnation_progress);
        for (unsigned int k = 0;; ++k)
          {
            const double gP = iterate.gradient_norm();
            if (stop(iterate.point(), gP))
              return Status::converged;
            if (stagnates(gP) || gP <= iterate.noise())
              return Status::stagnated;
            if (k == options.max_iterations)
              return Status::iteration_limit;
            const auto &split          = iterate.split();
            const bool is_proportional = split.chopped <= options.proportioning * options.proportioning * split.reduced;
            if (const Outcome outcome = is_proportional ? conjugate_gradients() : proportioning())
              return *outcome;
          }
      }

      Counts counts() const
      {
        Counts all                  = steps;
        all.hessian_multiplications = iterate.n_multiplications();
        return all;
      }

    private:
      // nullopt: continue.
      using Outcome   = std::optional<Status>;
      using Curvature = typename Iterate::Curvature;

      Outcome conjugate_gradients()
      {
        const Curvature c = iterate.curvature();
        if (const Outcome failure = check(c))
          return failure;
        if (is_flat(c))
          return leave_flat(c);
        if (c.pg <= 0) // rounding has destroyed the conjugacy
          return restart();
        if (!iterate.conjugate_step(c.pg / c.pAp, c.pAp))
          return expand(c);
        ++steps.cg_steps;
        is_conjugate = true;
        return {};
      }

      // The conjugate gradient step would leave the box. Starting from the boundary, projecting the rest of that step
      // gives the projection of the whole step.
      Outcome expand(const Curvature &c)
      {
        ++steps.expansion_steps;
        if (options.expansion == Expansion::gradient_projection)
          return project_gradient();
        const double optimal = c.pg / c.pAp, longest = std::min(optimal, iterate.longest_step());
        iterate.step(longest);
        if (options.expansion == Expansion::boundary_then_projection)
          iterate.template set_direction<&GradientParts::free>();
        else if (optimal <= longest)
          return restart();
        const bool projects_gradient = options.expansion == Expansion::boundary_then_projection;
        project_step(projects_gradient ? iterate.step_length() : optimal - longest);
        return {};
      }

      // Step along -beta, unless the bounds shorten it below 1/|A|, which is never more than the optimal length.
      Outcome proportioning()
      {
        ++steps.proportioning_steps;
        if (options.expansion == Expansion::gradient_projection)
          return project_gradient();
        iterate.template set_direction<&GradientParts::chopped>();
        is_conjugate         = false;
        const double longest = iterate.longest_step();
        if (longest * iterate.norm() < 1)
          return project_gradient();
        const Curvature c = iterate.curvature();
        if (const Outcome failure = check(c))
          return failure;
        if (is_flat(c))
          return leave_flat(c);
        iterate.step(std::min(c.pg / c.pAp, longest));
        return restart();
      }

      // x := projection of x - alpha gP, for discs of x - alpha g.
      Outcome project_gradient()
      {
        iterate.template set_direction<&GradientParts::descent>();
        return project_step(iterate.step_length()) ? Outcome() : Outcome(Status::stagnated);
      }

      // x := projection of x - length p. If that hardly decreases the objective (a length of 2/|A| may alternate
      // between two points), x := the best point on the way. Returns false if x does not move.
      bool project_step(const double length)
      {
        const auto trial = iterate.evaluate_trial(length);
        is_conjugate     = false;
        if (trial.change <= options.sufficient_decrease * trial.best_change + iterate.noise_of_change())
          iterate.accept_trial();
        else
          {
            iterate.move_towards_trial(trial.best_fraction);
            iterate.restart();
          }
        return trial.distance > 0;
      }

      Outcome restart()
      {
        iterate.restart();
        is_conjugate = false;
        return {};
      }

      static Outcome check(const Curvature &c)
      {
        return std::isfinite(c.pg) && std::isfinite(c.pAp) ? Outcome() : Outcome(Status::stagnated);
      }

      bool is_flat(const Curvature &c) const
      {
        return c.pAp <= options.smallest_curvature * iterate.norm() * c.pp;
      }

      // A p = 0 up to rounding: descend to the bounds.
      Outcome leave_flat(const Curvature &c)
      {
        if (c.pg <= iterate.noise() * std::sqrt(c.pp))
          return is_conjugate ? restart() : Status::stagnated;
        const double longest = iterate.longest_step();
        if (!std::isfinite(longest))
          return Status::infeasible;
        ++steps.expansion_steps;
        iterate.step(longest);
        return restart();
      }

      Iterate           &iterate;
      const MpgpOptions &options;
      Counts             steps;
      bool               is_conjugate = false; // p is not just a part of the gradient at x
    };
  } // namespace detail

  /// Minimises 1/2 x'Ax - x'b over the set (Box or DiscBox) until stop(x, |gP|) is true. `A(v, Av)` applies A,
  /// symmetric positive semidefinite; `norm` is |A|, preferably not too small; `stop` must return the same on all
  /// processes. A start outside the box is projected onto it. From x = 0, or from a start with gradient, there is no
  /// multiplication before the first step.
  /// status: converged if and only if stop() was true; stagnated at rounding level; infeasible if some lower > upper (x
  /// is then meaningless) or if the objective is unbounded from below.
  /// @code
  /// using Vector = std::vector<double>;
  /// const Vector      b{2, -3, 0.5};
  /// const Box<Vector> box{{-1, -1, -1}, {1, 1, 1}};
  /// const auto        A    = [](const Vector &x, Vector &Ax) { Ax = x; };
  /// const auto        stop = [](const Vector &, const double gradient) { return gradient <= 1e-12; };
  /// const auto        best = mpgp(A, 1., b, box, {Vector(3, 0.)}, stop, MpgpOptions(), SerialReduction());
  /// assert(best.status == Status::converged);
  /// assert(best.x == (Vector{1, -1, 0.5})); // b, clipped
  /// @endcode
  template <typename Vector,
            typename Set,
            typename Operator,
            typename Stop,
            typename Reduction,
            typename Tracker = NoTracker>
  MpgpResult<Vector> mpgp(Operator         &&A,
                          const double       norm,
                          const Vector      &b,
                          const Set         &set,
                          MpgpStart<Vector>  start,
                          const Stop        &stop,
                          const MpgpOptions &options,
                          const Reduction   &reduction,
                          Tracker          &&tracker = Tracker())
  {
    using Iterate =
      detail::MpgpIterate<Vector, Set, std::remove_reference_t<Operator>, Reduction, std::remove_reference_t<Tracker>>;
    Iterate               iterate(A, norm, b, set, std::move(start), options, reduction, tracker);
    detail::Mpgp<Iterate> method(iterate, options);
    const Status          status = method.run(stop);
    const double          gP     = iterate.gradient_norm();
    return {status, iterate.take_point(), iterate.take_gradient(), gP, iterate.norm(), method.counts()};
  }
} // namespace slipstick::qp
