#include <slipstick/contact/contact_algorithms.h>
#include <slipstick/contact/given_bounds.h>
#include <slipstick/contact/linear.h>
#include <slipstick/tfeti/face.h>

#include <algorithm>
#include <functional>
#include <utility>

namespace slipstick::contact
{
  namespace
  {
    using Vector = tfeti::DistributedVector;

    // Newton's method may take one step per this many bodies, if that is more than its usual limit: in the plane an
    // arch of 400 stones takes 44 steps, one of 1000 stones 127.
    constexpr unsigned int bodies_per_step = 5;

    const Box &bounds_of(const Box &set)
    {
      return set;
    }

    const Box &bounds_of(const qp::DiscBox<Vector> &set)
    {
      return set.box;
    }
  } // namespace

  bool ContactAlgorithms::newton(const Vector      &from,
                                 const bool         bounds_follow,
                                 const bool         is_rough,
                                 const unsigned int most_steps)
  {
    Vector d = dual.d();
    d /= dual.norm();
    qp::NewtonOptions how    = options.newton;
    const auto        bodies = static_cast<unsigned int>(dual.body_motions().names().size());
    how.max_outer_iterations = std::max(how.max_outer_iterations, bodies / bodies_per_step);
    if (most_steps > 0)
      how.max_outer_iterations = most_steps;
    auto followed = law.fixed_discs(solution.slip_bound, !bounds_follow);
    if (bounds_follow)
      followed.insert(followed.begin(), law.pressure_bounds().begin(), law.pressure_bounds().end());
    auto result = qp::semismooth_newton(dual,
                                        1.,
                                        d,
                                        qp::AdmissibleSet<Vector>{box, std::move(followed)},
                                        qp::NewtonStart<Vector>{from, gradient, solution.directions, is_rough},
                                        qp::Goal(options.tolerance, solution.weighted_reference, forces_before),
                                        how,
                                        counted(),
                                        acceptance(),
                                        qp::ErrorTest<Vector>([this](const Vector &x, const Vector &error) {
                                          return tractions->accepts(x, error);
                                        }));
    gradient.reset();
    solution.counts += result.counts;
    solution.status             = result.status;
    solution.projected_gradient = result.projected_gradient;
    solution.equality           = 0;
    solution.multipliers        = std::move(result.x);
    solution.gradient           = std::move(result.gradient);
    if (bounds_follow && law.depends_on_pressure())
      {
        solution.friction_iterations = result.counts.outer_iterations;
        const auto bounds            = law.bounds(solution.multipliers);
        solution.bound_change        = change_of_bounds(bounds, solution.multipliers);
        set_bounds(bounds);
      }
    return result.status == qp::Status::converged;
  }

  bool ContactAlgorithms::try_newton()
  {
    const auto before = solution;
    if (newton(before.multipliers, true))
      return true;
    const auto counts = solution.counts;
    solution          = before;
    solution.counts   = counts;
    set_bounds(before.slip_bound);
    return false;
  }

  template <typename Set>
  Vector ContactAlgorithms::smalbe_on(const Set          &set,
                                      const Vector       &from,
                                      const double        tolerance,
                                      const qp::Observer &progress,
                                      const bool          may_end_early,
                                      Reached            *reached,
                                      const unsigned int  most_multiplications)
  {
    const auto with_start = [&progress](qp::OuterStep step) {
      ++step.hessian_multiplications; // F x~ in the homogenised load
      if (progress)
        progress(step);
    };
    const auto load = homogenised_load(dual, from);
    if (options.algorithm == scene::Algorithm::semismooth_newton && solution.weighted_reference == 0)
      solution.weighted_reference = tfeti::residual_norm(dual, load);
    std::function<bool(const Vector &, const Vector &)> asks;
    if (is_accurate && may_end_early)
      asks = [&](const Vector &step, const Vector &g) {
        return accepts(unshifted(box, bounds_of(set), from, step), g);
      };
    auto how = options.smalbe;
    if (options.algorithm == scene::Algorithm::semismooth_newton)
      how.max_multiplications = most_multiplications;
    // solves of lower accuracy are continued in any case
    const double forces = tolerance <= options.tolerance && size_of_forces > 0 ? size_of_forces : qp::infinity;
    const auto   result = qp::smalbe(dual,
                                   1.,
                                   load,
                                   set,
                                   reached && *reached ? **reached : qp::SmalbeStart<Vector>{dual.zero()},
                                   qp::Goal(tolerance, solution.reference, forces),
                                   how,
                                   with_start,
                                   asks);
    solution.status     = result.status;
    solution.counts += result.counts;
    ++solution.counts.hessian_multiplications; // F x~ in the homogenised load
    solution.projected_gradient = result.projected_gradient;
    solution.equality           = result.equality_residual;
    solution.reference          = result.reference;
    gradient                    = result.gradient;
    solution.gradient.reset();
    if (reached)
      *reached = qp::SmalbeStart<Vector>{result.x, result.shift};
    return unshifted(box, bounds_of(set), from, result.x);
  }

  Vector ContactAlgorithms::smalbe(const Vector       &from,
                                   const double        tolerance,
                                   const qp::Observer &progress,
                                   const bool          may_end_early,
                                   Reached            *reached)
  {
    if (law.has_discs())
      return smalbe_on(shifted_discs(law, solution.slip_bound, box, from),
                       from,
                       tolerance,
                       progress,
                       false,
                       reached,
                       longest_fallback);
    return smalbe_on(shifted(box, from), from, tolerance, progress, may_end_early, reached, longest_fallback);
  }

  Vector ContactAlgorithms::start_by_smalbe(const Vector &feasible)
  {
    return smalbe_on(shifted(box, feasible),
                     feasible,
                     options.newton.start_tolerance,
                     {},
                     false,
                     nullptr,
                     law.depends_on_pressure() ? options.newton.start_multiplications_with_friction
                                               : options.newton.start_multiplications);
  }
} // namespace slipstick::contact
