#include <slipstick/base/exceptions.h>
#include <slipstick/base/log.h>
#include <slipstick/contact/bound_iteration.h>
#include <slipstick/contact/equilibrium_limit.h>
#include <slipstick/contact/friction.h>
#include <slipstick/contact/given_bounds.h>
#include <slipstick/contact/linear.h>
#include <slipstick/contact/no_forces.h>
#include <slipstick/qp/feasible_point.h>
#include <slipstick/tfeti/diagnosis.h>
#include <slipstick/tfeti/face.h>

#include <algorithm>
#include <array>
#include <memory>
#include <optional>
#include <utility>

namespace slipstick::contact
{
  namespace
  {
    using Vector = tfeti::DistributedVector;

    // Loads below this fraction of those of earlier steps are zero up to rounding.
    constexpr double rounding_of_loads = 1e-12;
    // Newton steps on sliding solids after which the solver checks whether friction can bear the loads at all: if it
    // cannot, more steps find nothing.
    constexpr unsigned int steps_before_overload = 30;
    // The check uses the normal forces of the problem with this many times the friction (the first that has
    // a solution), ...
    constexpr std::array<double, 3> more_friction{{4, 64, 1024}};
    // ... and then with this many times the friction that those normal forces require.
    constexpr double margin_of_friction = 1.1;

    /// Whether any pair is not bonded. Bonded pairs alone make a linear problem, whatever algorithm is selected.
    template <int dim>
    bool has_bounds(const scene::Scene<dim> &scene)
    {
      return (scene.contact_search.automatic && !scene.contact_search.pair.law.is_bonded) ||
             std::any_of(scene.contacts.begin(), scene.contacts.end(), [](const auto &pair) {
               return !pair.law.is_bonded;
             });
    }

    /// @param unbalanced fraction of the loads that the forces found do not balance.
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

    /// Computes the solution, or finds the reason why there is none.
    class ContactSolver : BoundIteration
    {
    public:
      using BoundIteration::BoundIteration;

      DualSolution run(const DualSolution *start)
      {
        const auto feasible = feasible_start(start);
        solution.algorithm  = options.algorithm == scene::Algorithm::semismooth_newton
                                ? scene::Algorithm::semismooth_newton
                                : scene::Algorithm::smalbe;
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

      /// After no solution was found: throws if friction is too weak for the loads along a motion that nothing else
      /// resists. The normal forces of the failed search only raise the suspicion; those of a solution with more
      /// friction decide.
      void refuse_overload(const Vector &feasible, const DualSolution *start)
      {
        if (is_no_overload || !law.depends_on_pressure() || !weakest_motion(dual, law, solution.multipliers, 1))
          return;
        is_no_overload = true; // unless an error is thrown below
        for (const double more : more_friction)
          {
            const auto held = forces_with_scaled_friction(more, feasible, start);
            if (!held)
              continue;
            auto overload = weakest_motion(dual, law, *held, 1);
            if (!overload)
              return;
            const double least = margin_of_friction / overload->held;
            if (least < more) // closer to sliding, the normal forces are closer to those of this problem
              if (const auto nearer = forces_with_scaled_friction(least, feasible, start))
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

      /// The forces with @p more times the friction, if the algorithm finds them.
      std::optional<Vector> forces_with_scaled_friction(const double        more,
                                                        const Vector       &feasible,
                                                        const DualSolution *start)
      {
        const SlipLaw          with_more = law.scaled(more);
        const ProgressObserver count     = [this](Progress progress) { counted()(progress.step); };
        const AccuracyTest     none;
        ContactSolver          held(dual, with_more, options, friction, count, none);
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

      /// The start from which the first set is predicted: that of the previous load step, or else a few steps of
      /// SMALBE-M.
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

      /// The forces nearest to the start of Newton's method that balance the loads within the bounds at that start,
      /// which become the present bounds; if there are none, the feasible forces with theirs.
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
        qp::project(box, *near); // exactly within the bounds
        return *std::move(near);
      }

      /// Newton's method from a start. In space it ends early, with an error, if friction cannot bear the loads.
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

      bool is_no_overload = false; // problems with more friction did not show that friction is too weak
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
    else if (options.algorithm == scene::Algorithm::smalbe) // would transform the bounds, but estimates errors
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
