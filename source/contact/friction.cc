#include <slipstick/base/exceptions.h>
#include <slipstick/base/log.h>
#include <slipstick/contact/bound_damping.h>
#include <slipstick/contact/equilibrium_limit.h>
#include <slipstick/contact/friction.h>
#include <slipstick/contact/given_bounds.h>
#include <slipstick/contact/linear.h>
#include <slipstick/contact/no_forces.h>
#include <slipstick/contact/traction_error.h>
#include <slipstick/qp/feasible_point.h>
#include <slipstick/qp/semismooth_newton.h>
#include <slipstick/qp/smalbe.h>
#include <slipstick/tfeti/diagnosis.h>
#include <slipstick/tfeti/face.h>

#include <deal.II/base/mpi.h>

#include <algorithm>
#include <cmath>

namespace slipstick::contact
{
  namespace
  {
    using Vector = tfeti::DistributedVector;

    // Slip bounds are followed at residuals below this times their last relative change (SMALBE).
    constexpr double bound_accuracy = 0.1;
    // ... at this one at first ...
    constexpr double first_accuracy = 1e-2;
    // ... then at most this part of the one before, for the noise of a solution hides how the bounds change ...
    constexpr double accuracy_reduction = 0.5;
    // ... and never below this part of the tolerance.
    constexpr double least_accuracy = 1e-3;
    // Loads below this part of those of earlier steps are what rounding leaves of none.
    constexpr double rounding_of_loads = 1e-12;
    // SMALBE-M is taken over by Newton's method at this residual, ...
    constexpr double first_takeover = 0.1;
    // ... or at so much smaller ones, ...
    constexpr double takeover_reduction = 0.3;
    // ... down to this one: where Newton's method fails even there, rounding is in its way.
    constexpr double last_takeover = 1e-3;
    // Newton's steps on solids that slide after which it is asked whether friction bears the loads at all: where it does not,
    // more of them find nothing.
    constexpr unsigned int steps_before_overload = 30;
    // That is told by the normal forces that hold them with so many times the friction, the first that does, ...
    constexpr std::array<double, 3> more_friction{{4, 64, 1024}};
    // ... and with so many times the friction that these need.
    constexpr double margin_of_friction = 1.1;
    // In the plane one for so many bodies, if that is more than usual: an arch of 400 stones takes 44, one of 1000 127.
    constexpr unsigned int bodies_per_step = 5;
    // Multiplications after which Newton's method and its fallback give up.
    constexpr unsigned int longest_fallback = 5000;
    // Blends of old and new bounds that are tried when the new ones admit no equilibrium.
    constexpr unsigned int max_blends = 20;

    /// Bonded pairs alone leave a linear problem, whatever algorithm is asked for.
    template <int dim>
    bool has_bounds(const scene::Scene<dim> &scene)
    {
      return (scene.contact_search.automatic && !scene.contact_search.pair.law.is_bonded) ||
             std::any_of(scene.contacts.begin(), scene.contacts.end(), [](const auto &pair) {
               return !pair.law.is_bonded;
             });
    }

    /// @param unbalanced the part of the loads that the forces found do not balance.
    [[noreturn]] void no_equilibrium(const tfeti::DualProblem &dual, const Vector &certificate, const double unbalanced)
    {
      throw NoEquilibrium(
        (unbalanced < nearness_of_limit
           ? format(
               "no contact forces within their bounds balance the last %.1e of the loads, at the limit of equilibrium: they "
               "move ",
               unbalanced)
           : "no contact forces within their bounds balance the loads, which move ") +
          tfeti::describe(tfeti::motion_behind(dual, certificate), dual.body_motions().names()),
        "support the body against this motion, raise friction coefficient or slip bound, or turn the loads towards the "
        "contact");
    }

    /// A contact problem on its way to the solution: the law with its present bounds, and all that is counted.
    class ContactSolver
    {
    public:
      ContactSolver(const tfeti::DualProblem     &dual_,
                    const SlipLaw                &law_,
                    const scene::SolverOptions   &options_,
                    const scene::FrictionOptions &friction_,
                    const ProgressObserver       &observer_,
                    const AccuracyTest           &is_accurate_)
        : dual(dual_)
        , law(law_)
        , options(options_)
        , friction(friction_)
        , observer(observer_)
        , is_accurate(is_accurate_)
      {}

      DualSolution run(const DualSolution *start)
      {
        const auto feasible = feasible_start(start);
        solution.algorithm  = options.algorithm == scene::Algorithm::semismooth_newton ? "semismooth newton" : "smalbe";
        set_bounds(law.bounds(feasible));
        if (all_forces_vanish(dual, feasible, box, solution.slip_bound))
          {
            solution.multipliers = dual.zero();
            return finished();
          }
        if (options.algorithm == scene::Algorithm::semismooth_newton)
          {
            const auto from = newton_start(feasible, start);
            if (solution.weighted_reference == 0) // neither load nor gap: the start is the solution
              {
                solution.multipliers = from;
                return finished();
              }
            if (newton_from(from, feasible, start))
              return finished();
            refuse_overload(feasible, start);
            ++solution.fallbacks;
            follow_bounds_to_the_end(fallback_start(from, feasible), feasible);
          }
        else
          follow_bounds_to_the_end(feasible, feasible);
        if (solution.status != qp::Status::converged)
          refuse_overload(feasible, start);
        return finished();
      }

    private:
      /// The admissible forces nearest to zero that balance the loads.
      Vector feasible_start(const DualSolution *start)
      {
        const auto loads = dual.particular();
        set_scales(loads, start);
        if (start && loads.l2_norm() <= rounding_of_loads * start->reference) // unloaded to zero
          return dual.zero();
        auto point = qp::feasible_point(dual, loads, law.admissible(dual));
        if (point.status == qp::Status::infeasible)
          no_equilibrium(dual, point.certificate, point.residual);
        size_of_forces = point.x.l2_norm();
        return std::move(point.x);
      }

      /// Scales of forces and tractions, from the loads and the load step before.
      void set_scales(const Vector &loads, const DualSolution *start)
      {
        forces_before = start ? start->largest_forces : 0.;
        tractions.emplace(dual, options.tolerance, loads.linfty_norm(), start ? start->largest_traction : 0.);
      }

      /// Where no solution was found: is friction too weak for the loads along a motion that nothing else resists? The
      /// normal forces that the search came to only raise the question: those count that hold the loads with more friction.
      void refuse_overload(const Vector &feasible, const DualSolution *start)
      {
        if (is_no_overload || !law.depends_on_pressure() || !weakest_motion(dual, law, solution.multipliers, 1))
          return;
        is_no_overload = true; // unless an error says the opposite
        for (const double more : more_friction)
          {
            const auto held = held_by(more, feasible, start);
            if (!held)
              continue;
            auto overload = weakest_motion(dual, law, *held, 1);
            if (!overload)
              return;
            const double least = margin_of_friction / overload->held;
            if (least < more) // nearer to sliding the normal forces are more nearly its own
              if (const auto nearer = held_by(least, feasible, start))
                overload = weakest_motion(dual, law, *nearer, 1);
            if (!overload)
              return;
            throw NoEquilibrium(
              (overload->held > 1 - nearness_of_limit ? "friction is at the limit of equilibrium: "
                                                      : "friction is too weak: ") +
                describe(*overload, dual.body_motions().names()),
              "raise the friction coefficient or the normal force, support the body against this motion, or lower the load");
          }
      }

      /// The forces with so many times the friction, if the algorithm finds them.
      std::optional<Vector> held_by(const double more, const Vector &feasible, const DualSolution *start)
      {
        const SlipLaw          with_more = law.scaled(more);
        const ProgressObserver goes_on   = [this](Progress progress) { counted()(progress.step); };
        const AccuracyTest     none;
        ContactSolver          held(dual, with_more, options, friction, goes_on, none);
        const bool             is_held = held.converges(feasible, start);
        solution.counts += held.solution.counts;
        multiplications_beside += held.solution.counts.hessian_multiplications;
        return is_held ? std::optional(std::move(held.solution.multipliers)) : std::nullopt;
      }

      /// The algorithm without fallback. @return convergence.
      bool converges(const Vector &feasible, const DualSolution *start)
      {
        set_scales(dual.particular(), start);
        size_of_forces = feasible.l2_norm();
        set_bounds(law.bounds(feasible));
        if (options.algorithm == scene::Algorithm::smalbe)
          {
            follow_bounds_to_the_end(feasible, feasible);
            return solution.status == qp::Status::converged;
          }
        const auto from = newton_start(feasible, start);
        return solution.weighted_reference > 0 && newton(from, true, !start);
      }

      void set_bounds(std::vector<double> bounds)
      {
        solution.slip_bound = std::move(bounds);
        box                 = multiplier_box(dual, solution.slip_bound);
      }

      /// Counts of finished parts are added to what the observer is told of a part under way.
      qp::Observer counted(const unsigned int before_step = 0) const
      {
        return [this, before_step](qp::OuterStep step) {
          step.hessian_multiplications += solution.counts.hessian_multiplications + before_step;
          step.outer += solution.counts.outer_iterations;
          if (observer)
            observer({step, solution.friction_iterations});
        };
      }

      /// Relative change from the present bounds to those of x, over all ranks, of rows that feel it: x strictly inside both
      /// solves with either.
      double change_of_bounds(const std::vector<double> &next, const Vector &x) const
      {
        std::array<double, 2>     s{{0, 0}};
        const std::vector<double> size = sizes(x);
        for (unsigned int r = 0; r < next.size(); ++r)
          {
            const bool   is_inside = size[r] < std::min(next[r], solution.slip_bound[r]);
            const double change    = is_inside ? 0. : next[r] - solution.slip_bound[r];
            s[0] += change * change;
            s[1] += next[r] * next[r];
          }
        s = dual.reduction().sum(s);
        return s[0] == 0 ? 0. : s[1] > 0 ? std::sqrt(s[0] / s[1]) : 1.;
      }

      /// Of every owned row the size of its multiplier; in space tangential ones have that of both.
      std::vector<double> sizes(const Vector &x) const
      {
        std::vector<double> result(x.locally_owned_size());
        for (unsigned int r = 0; r < result.size(); ++r)
          result[r] = std::abs(x.local_element(r));
        for (const auto &point : dual.constraints().contact_points)
          if (point.second_row != tfeti::invalid_row && point.tangential_row != tfeti::invalid_row)
            result[point.tangential_row] = result[point.second_row] =
              std::hypot(result[point.tangential_row], result[point.second_row]);
        return result;
      }

      std::vector<double> blend(const std::vector<double> &next, const double part) const
      {
        std::vector<double> result(next.size());
        for (unsigned int r = 0; r < next.size(); ++r)
          result[r] = (1 - part) * solution.slip_bound[r] + part * next[r];
        return result;
      }

      /// A few steps of SMALBE-M, or the load step before, tell the first set.
      Vector newton_start(const Vector &feasible, const DualSolution *start)
      {
        solution.directions = start && start->directions
                                ? start->directions
                                : std::make_shared<qp::DirectionStore<Vector>>(options.newton.n_directions);
        if (start)
          {
            const auto load             = homogenised_load(dual, feasible);
            solution.reference          = std::max(start->reference, load.l2_norm());
            solution.weighted_reference = std::max(start->weighted_reference, tfeti::residual_norm(dual, load));
            ++solution.counts.hessian_multiplications;
            set_bounds(law.bounds(start->multipliers));
            gradient = start->gradient;
            return start->multipliers;
          }
        Vector from                      = start_by_smalbe(feasible);
        solution.counts.outer_iterations = 0;
        set_bounds(law.bounds(from));
        return from;
      }

      /// The forces nearest to those from which Newton's method began that balance the loads within the bounds there, which
      /// become the present ones; where none do, the feasible ones.
      Vector fallback_start(const Vector &from, const Vector &feasible)
      {
        auto bounds = law.bounds(from);
        auto near   = nearest_feasible(dual, law, bounds, from);
        if (!near)
          {
            set_bounds(law.bounds(feasible));
            return feasible;
          }
        set_bounds(std::move(bounds));
        qp::project(box, *near); // to the last bit
        return *std::move(near);
      }

      /// Asks whether x, moved to its bounds, is accurate enough. @p g: gradient F x - d + G'a (scaled).
      bool accepts(const Vector &x, const Vector &g)
      {
        DualSolution iterate;
        iterate.multipliers = x;
        iterate.slip_bound  = law.depends_on_pressure() ? law.bounds(x) : solution.slip_bound;
        iterate.free.resize(x.locally_owned_size());
        const Box at    = multiplier_box(dual, iterate.slip_bound);
        Vector    jumps = g;
        qp::project(at, iterate.multipliers);
        for (unsigned int r = 0; r < iterate.free.size(); ++r)
          {
            const double y = iterate.multipliers.local_element(r), l = at.lower.local_element(r),
                         u         = at.upper.local_element(r);
            iterate.free[r]        = y > l && y < u;
            jumps.local_element(r) = dual.norm() * qp::projected_gradient(y, g.local_element(r), l, u);
          }
        return is_accurate(iterate, residual_energy(dual, jumps));
      }

      qp::Acceptance<Vector> acceptance()
      {
        if (!is_accurate)
          return {};
        return [this](const Vector &x, const Vector &g) { return accepts(x, g); };
      }

      /// Newton's method from a start; in space loads that friction cannot bear end it early, with an error.
      bool newton_from(const Vector &from, const Vector &feasible, const DualSolution *start)
      {
        if (!law.has_discs())
          return newton(from, true, !start);
        if (newton(from, true, !start, steps_before_overload))
          return true;
        if (solution.status != qp::Status::iteration_limit)
          return false;
        refuse_overload(feasible, start);
        gradient             = solution.gradient;
        const bool is_solved = newton(Vector(solution.multipliers), true);
        if (law.depends_on_pressure())
          solution.friction_iterations += steps_before_overload;
        return is_solved;
      }

      /// Semismooth Newton, with bounds that follow the solution or (a Tresca problem) as they are. @return convergence.
      /// @param is_rough is the start far from the solution? @param most_steps at most, if given.
      bool newton(const Vector      &from,
                  const bool         bounds_follow,
                  const bool         is_rough   = false,
                  const unsigned int most_steps = 0)
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
                                              return tractions->is_small(x, error);
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

      /// Where SMALBE-M ends without convergence its set may be near the right one, on which Newton's method solves.
      void follow_bounds_to_the_end(const Vector &from, const Vector &feasible)
      {
        follow_bounds(from);
        const bool follows =
          law.depends_on_pressure() && solution.friction_iterations > 0; // not a limit of SMALBE alone
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

      /// Newton's method from the present point, which stays when that does not converge. @return convergence.
      bool try_newton()
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

      /// The problem with its present bounds, from a point that balances the loads within them: by SMALBE-M, or, where
      /// that is not what was asked for, by Newton's method first.
      void solve_within_bounds(const Vector &from, const double accuracy, const bool may_end_early)
      {
        if (options.algorithm == scene::Algorithm::semismooth_newton && law.depends_on_pressure() &&
            newton(from, false))
          return;
        solution.multipliers = smalbe(from, accuracy, counted(), may_end_early);
      }

      /// Where Newton's method ended far from the solution, SMALBE-M comes nearer and nearer to it until that converges from
      /// there.
      bool newton_from_smalbe(const Vector &from)
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

      /// Newton's method is tried again after 1, 2, 4, 8, ... rounds: a part of the cost of these, whatever they are.
      bool is_due(const unsigned int rounds) const
      {
        return options.algorithm == scene::Algorithm::semismooth_newton && (rounds & (rounds - 1)) == 0;
      }

      /// Fixed point of the bounds.
      void follow_bounds(Vector from)
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

      /// Takes the part of the way to the next bounds that admits an equilibrium; `from` is moved to the nearest one.
      bool move_bounds(const std::vector<double> &next, double part, Vector &from)
      {
        for (unsigned int k = 0; k < max_blends; ++k, part /= 2)
          {
            const auto bounds = blend(next, part);
            const auto near   = nearest_feasible(dual, law, bounds, solution.multipliers);
            if (!near)
              continue;
            from = *near;
            set_bounds(bounds);
            qp::project(box, from); // to the last bit
            return true;
          }
        return false;
      }

      /// Where SMALBE-M came to with the same bounds and the same point that balances the loads.
      using Reached = std::optional<qp::SmalbeStart<Vector>>;

      /// SMALBE-M (with discs SMALSE-M) from a point that balances the loads within the present bounds, or from where it came
      /// to; fills status and residuals.
      Vector smalbe(const Vector       &from,
                    const double        tolerance,
                    const qp::Observer &progress,
                    const bool          may_end_early = false,
                    Reached            *reached       = nullptr)
      {
        if (law.has_discs())
          return smalbe_on(shifted_discs(law, solution.slip_bound, box, from),
                           from,
                           tolerance,
                           progress,
                           false,
                           reached);
        return smalbe_on(shifted(box, from), from, tolerance, progress, may_end_early, reached);
      }

      /// A few steps, in space with squares around the discs: they tell the first set as well.
      Vector start_by_smalbe(const Vector &feasible)
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

      template <typename Set>
      Vector smalbe_on(const Set          &set,
                       const Vector       &from,
                       const double        tolerance,
                       const qp::Observer &progress,
                       const bool          may_end_early,
                       Reached            *reached,
                       const unsigned int  most_multiplications = longest_fallback)
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
        // at lower accuracy it goes on all the same
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

      static const Box &bounds_of(const Box &set)
      {
        return set;
      }
      static const Box &bounds_of(const qp::DiscBox<Vector> &set)
      {
        return set.box;
      }

      /// Fills which inequality rows are at a bound, or as near as rounding.
      DualSolution finished()
      {
        unsigned long long n     = 0;
        const double       noise = tfeti::force_rounding * solution.multipliers.linfty_norm();
        const auto         size  = sizes(solution.multipliers);
        solution.free.resize(solution.multipliers.locally_owned_size());
        for (unsigned int r = 0; r < solution.free.size(); ++r)
          {
            const double x   = solution.multipliers.local_element(r);
            solution.free[r] = x - box.lower.local_element(r) > noise && box.upper.local_element(r) - x > noise;
            if (law.has_discs() && dual.constraints().kind[r] == tfeti::RowKind::tangential)
              solution.free[r] = solution.slip_bound[r] - size[r] > noise;
            n += !solution.free[r];
          }
        solution.active_constraints = dealii::Utilities::MPI::sum(n, dual.communicator());
        solution.largest_forces     = std::max(forces_before, solution.multipliers.l2_norm());
        solution.largest_traction   = tractions->largest(solution.multipliers);
        return std::move(solution);
      }

      const tfeti::DualProblem     &dual;
      const SlipLaw                &law;
      const scene::SolverOptions   &options;
      const scene::FrictionOptions &friction;
      const ProgressObserver       &observer;
      const AccuracyTest           &is_accurate;

      Box box;
      std::optional<Vector>
                   gradient; // that tells Newton's method its first set: where SMALBE-M or the step before ended
      DualSolution solution;

      double                       size_of_forces = 0; // of the least forces found that balance the loads [N]
      double                       forces_before  = 0; // as DualSolution::largest_forces
      std::optional<TractionError> tractions;

      unsigned long long multiplications_beside = 0;     // of problems with more friction, ...
      bool               is_no_overload         = false; // ... which did not say that friction is too weak
    };
  } // namespace

  template <int dim>
  std::vector<double> slip_bounds(const scene::Scene<dim> &scene, const tfeti::DualProblem &dual, const double t)
  {
    return SlipLaw(scene, dual, t).bounds(dual.zero());
  }

  template <int dim>
  scene::SolverOptions resolved_options(const scene::Scene<dim> &scene)
  {
    scene::SolverOptions options        = scene.solver;
    auto                &preconditioner = options.dual.preconditioner;
    if (options.algorithm == scene::Algorithm::automatic)
      options.algorithm = scene.has_contact() ? scene::Algorithm::semismooth_newton : scene::Algorithm::pcg;
    if (options.algorithm == scene::Algorithm::smalbe && !has_bounds(scene))
      preconditioner = tfeti::Preconditioner::dirichlet;
    else if (options.algorithm == scene::Algorithm::smalbe) // would change the bounds; but it tells energies of errors
      preconditioner =
        options.stops_at_discretization_error ? tfeti::Preconditioner::dirichlet : tfeti::Preconditioner::none;
    else if (preconditioner == tfeti::Preconditioner::automatic)
      preconditioner = tfeti::Preconditioner::dirichlet;
    return options;
  }

  DualSolution solve(const tfeti::DualProblem     &dual,
                     const SlipLaw                &law,
                     const scene::SolverOptions   &options,
                     const scene::FrictionOptions &friction,
                     const ProgressObserver       &observer,
                     const DualSolution           *start,
                     const AccuracyTest           &is_accurate)
  {
    const auto &counts = dual.constraints().counts;
    if (counts.normal + counts.tangential == 0)
      return solve_linear(dual, options, observer, start, is_accurate);
    return ContactSolver(dual, law, options, friction, observer, is_accurate).run(start);
  }

  DualSolution solve(const tfeti::DualProblem   &dual,
                     const std::vector<double>  &slip_bound,
                     const scene::SolverOptions &options,
                     const qp::Observer         &observer)
  {
    return solve(dual, SlipLaw(slip_bound), options, scene::FrictionOptions(), [&observer](const Progress &progress) {
      if (observer)
        observer(progress.step);
    });
  }

  template scene::SolverOptions resolved_options(const scene::Scene<2> &);
  template scene::SolverOptions resolved_options(const scene::Scene<3> &);
  template std::vector<double>  slip_bounds(const scene::Scene<2> &, const tfeti::DualProblem &, const double);
  template std::vector<double>  slip_bounds(const scene::Scene<3> &, const tfeti::DualProblem &, const double);
} // namespace slipstick::contact
