#include <slipstick/contact/bound_damping.h>
#include <slipstick/contact/bound_iteration.h>
#include <slipstick/contact/given_bounds.h>
#include <slipstick/contact/linear.h>
#include <slipstick/qp/box.h>
#include <slipstick/tfeti/face.h>

#include <algorithm>
#include <utility>

namespace slipstick::contact
{
  namespace
  {
    // Problems with given bounds are solved to this times the last relative change of the bounds (SMALBE), ...
    constexpr double bound_accuracy = 0.1;
    // ... to this residual at first, ...
    constexpr double first_accuracy = 1e-2;
    // ... then to at most this fraction of the previous one, since errors of solutions hide the change of bounds, ...
    constexpr double accuracy_reduction = 0.5;
    // ... and never below this fraction of the tolerance.
    constexpr double least_accuracy = 1e-3;
    // Newton's method takes over from SMALBE-M at this residual, ...
    constexpr double first_takeover = 0.1;
    // ... then at residuals smaller by this factor each time, ...
    constexpr double takeover_reduction = 0.3;
    // ... down to this one: if Newton's method fails even there, rounding prevents its convergence.
    constexpr double last_takeover = 1e-3;
    // Blends of old and new bounds that are tried when the new ones admit no equilibrium.
    constexpr unsigned int max_blends = 20;
  } // namespace

  BoundIteration::BoundIteration(const tfeti::DualProblem     &dual_,
                                 const SlipLaw                &law_,
                                 const scene::SolverOptions   &options_,
                                 const scene::FrictionOptions &friction_,
                                 const ProgressObserver       &observer_,
                                 const AccuracyTest           &is_accurate_)
    : ContactAlgorithms(dual_, law_, options_, observer_, is_accurate_)
    , friction(friction_)
  {}

  void BoundIteration::follow_bounds_to_the_end(const Vector &from, const Vector &feasible)
  {
    follow_bounds(from);
    const bool follows = law.depends_on_pressure() && solution.friction_iterations > 0; // not SMALBE's own limit
    if (solution.status != qp::Status::stagnated && !(solution.status == qp::Status::iteration_limit && follows))
      return;
    ++solution.fallbacks;
    if (solution.weighted_reference == 0)
      {
        solution.weighted_reference = tfeti::residual_norm(dual, homogenised_load(dual, feasible));
        ++solution.counts.hessian_multiplications;
      }
    try_newton();
  }

  void BoundIteration::follow_bounds(Vector from)
  {
    if (!law.depends_on_pressure())
      {
        if (!(options.algorithm == scene::Algorithm::semismooth_newton && newton_from_smalbe(from)))
          solve_within_bounds(from, options.tolerance, true);
        return;
      }
    double accuracy              = std::max(options.tolerance, first_accuracy);
    solution.friction_iterations = 0;
    BoundDamping damping;
    for (;; ++solution.friction_iterations)
      {
        solve_within_bounds(from, accuracy, false);
        const auto next       = law.bounds(solution.multipliers);
        solution.bound_change = change_of_bounds(next, solution.multipliers);
        if (solution.status != qp::Status::converged ||
            (solution.bound_change <= friction.tolerance && accuracy <= options.tolerance))
          return;
        if (is_due(solution.friction_iterations + 1) && try_newton())
          return;
        if (solution.friction_iterations >= friction.max_iterations ||
            (options.algorithm == scene::Algorithm::semismooth_newton &&
             solution.counts.hessian_multiplications > longest_fallback + multiplications_beside))
          {
            solution.status = qp::Status::iteration_limit;
            return;
          }
        accuracy = std::max(std::min(accuracy > options.tolerance ? accuracy_reduction * accuracy : accuracy,
                                     bound_accuracy * solution.bound_change),
                            least_accuracy * options.tolerance);
        if (!move_bounds(next, damping(solution.bound_change), from))
          {
            solution.status = qp::Status::stagnated;
            return;
          }
      }
  }

  void BoundIteration::solve_within_bounds(const Vector &from, const double accuracy, const bool may_end_early)
  {
    if (options.algorithm == scene::Algorithm::semismooth_newton && law.depends_on_pressure() && newton(from, false))
      return;
    solution.multipliers = smalbe(from, accuracy, counted(), may_end_early);
  }

  bool BoundIteration::newton_from_smalbe(const Vector &from)
  {
    if (solution.projected_gradient <= last_takeover)
      return false;
    Reached reached;
    for (double accuracy = first_takeover; accuracy > std::max(options.tolerance, last_takeover);
         accuracy *= takeover_reduction)
      {
        solution.multipliers = smalbe(from, accuracy, counted(), false, &reached);
        if (solution.status != qp::Status::converged)
          return false;
        if (try_newton())
          return true;
      }
    return false;
  }

  bool BoundIteration::is_due(const unsigned int rounds) const
  {
    return options.algorithm == scene::Algorithm::semismooth_newton && (rounds & (rounds - 1)) == 0;
  }

  std::vector<double> BoundIteration::blend(const std::vector<double> &next, const double part) const
  {
    std::vector<double> result(next.size());
    for (unsigned int r = 0; r < next.size(); ++r)
      result[r] = (1 - part) * solution.slip_bound[r] + part * next[r];
    return result;
  }

  bool BoundIteration::move_bounds(const std::vector<double> &next, double part, Vector &from)
  {
    for (unsigned int k = 0; k < max_blends; ++k, part /= 2)
      {
        const auto bounds = blend(next, part);
        const auto near   = nearest_feasible(dual, law, bounds, solution.multipliers);
        if (!near)
          continue;
        from = *near;
        set_bounds(bounds);
        qp::project(box, from); // exactly within the bounds
        return true;
      }
    return false;
  }
} // namespace slipstick::contact
