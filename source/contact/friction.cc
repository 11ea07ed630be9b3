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

#include <deal.II/base/mpi.h>

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
    // Without loads, forces below the tolerance times those of earlier load steps are rounding; the factor is at least
    // and at most this.
    constexpr double sure_rounding = 1e-6, largest_part_of_rounding = 1e-4;
    // Newton steps on sliding solids after which the solver checks whether friction can bear the loads at all: if it
    // cannot, more steps find nothing.
    constexpr unsigned int steps_before_overload = 30;
    // The check uses the normal forces of the problem with this many times the friction (the first that has
    // a solution), ...
    constexpr std::array<double, 3> more_friction{{4, 64, 1024}};
    // ... then with this many times the friction that those normal forces require, ...
    constexpr double margin_of_friction = 1.1;
    // ... and then with this many times the additional friction that the last normal forces require, ...
    constexpr double margin_of_additional_friction = 2;
    // ... until the part of the loads that friction bears changes by less than this fraction of what is missing.
    constexpr double settled_part = 0.1;

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
          solution.multipliers = dual.zero();
        else
          search(feasible, start);
        if (start && feasible.linfty_norm() == 0 && only_rounding_remains())
          release();
        return finished();
      }

    private:
      void search(const Vector &feasible, const DualSolution *start)
      {
        if (options.algorithm == scene::Algorithm::semismooth_newton)
          {
            const auto from = newton_start(feasible, start);
            if (solution.weighted_reference == 0) // neither load nor gap: the start is the solution
              {
                solution.multipliers = from;
                return;
              }
            if (newton_from(from, feasible, start))
              return;
            refuse_overload(feasible, start);
            if (newton_from_nearby())
              return;
            ++solution.fallbacks;
            follow_bounds_to_the_end(fallback_start(from, feasible), feasible);
          }
        else
          follow_bounds_to_the_end(feasible, feasible);
        if (solution.status != qp::Status::converged)
          refuse_overload(feasible, start);
      }

      /// Whether the forces found are nothing beside those of earlier load steps, and zero forces are a solution as
      /// well: bodies that were unloaded. Otherwise rounding would decide where loose bodies end.
      bool only_rounding_remains() const
      {
        const double least   = std::clamp(options.tolerance, sure_rounding, largest_part_of_rounding);
        double       overlap = 0;
        for (unsigned int r = 0; r < dual.constraints().kind.size(); ++r)
          if (const auto kind = dual.constraints().kind[r]; kind != tfeti::RowKind::tangential)
            overlap =
              std::max(overlap, is_equality(kind) ? std::abs(dual.d().local_element(r)) : dual.d().local_element(r));
        return solution.multipliers.l2_norm() <= least * forces_before &&
               dealii::Utilities::MPI::max(overlap, dual.communicator()) == 0;
      }

      void release()
      {
        solution.multipliers        = dual.zero();
        solution.status             = qp::Status::converged;
        solution.projected_gradient = 0;
        solution.bound_change       = 0;
        solution.gradient.reset();
        set_bounds(law.bounds(solution.multipliers));
      }

      /// The admissible forces nearest to zero that balance the loads.
      Vector feasible_start(const DualSolution *start)
      {
        const auto loads = dual.particular();
        set_scales(loads, start);
        if (start && loads.l2_norm() <= rounding_of_loads * start->reference) // unloaded to zero
          return dual.zero();
        qp::FeasiblePointOptions how;
        how.seeks_proof = true;
        auto point      = qp::feasible_point(dual, loads, law.admissible(dual), how);
        if (point.status == qp::Status::infeasible)
          no_equilibrium(dual, point.certificate, point.residual);
        size_of_forces = point.x.l2_norm();
        return std::move(point.x);
      }

      /// After no solution was found: throws if friction is too weak for the loads along a motion that nothing else
      /// resists. The normal forces of the failed search only raise the suspicion. Those of solutions with more
      /// friction decide, where they no longer change with less of it: normal forces may depend on friction, as those
      /// under a wedge do. Otherwise the last of these solutions becomes `nearby`.
      void refuse_overload(const Vector &feasible, const DualSolution *start)
      {
        if (is_no_overload || !law.depends_on_pressure() || !weakest_motion(dual, law, solution.multipliers, 1))
          return;
        is_no_overload = true; // unless an error is thrown below
        for (const double more : more_friction)
          {
            nearby = with_friction(more, feasible, start);
            if (!nearby)
              continue;
            auto   overload = weakest_motion(dual, law, nearby->multipliers, 1);
            double factor = more, before = -qp::infinity;
            while (overload && std::abs(overload->held - before) > settled_part * (1 - overload->held))
              {
                const double less = factor == more ? margin_of_friction / overload->held
                                                   : 1 + margin_of_additional_friction * (1 / overload->held - 1);
                if (!(less < factor))
                  break;
                auto closer = with_friction(less, feasible, &*nearby);
                if (!closer)
                  return;
                factor   = less;
                before   = overload->held;
                nearby   = std::move(closer);
                overload = weakest_motion(dual, law, nearby->multipliers, 1);
              }
            if (!overload)
              return;
            throw NoEquilibrium(
              (overload->held > 1 - nearness_of_limit ? "friction is at the limit of equilibrium: "
                                                      : "friction is too weak: ") +
                describe(*overload, dual.body_motions().names()),
              "raise the friction coefficient or the normal force, support the body against this motion, or lower the load");
          }
      }

      /// Newton's method from the solution with more friction, if there is one.
      bool newton_from_nearby()
      {
        if (!nearby)
          return false;
        set_bounds(law.bounds(nearby->multipliers));
        gradient = nearby->gradient;
        return newton(nearby->multipliers, true);
      }

      /// The solution with @p more times the friction, if the algorithm finds it.
      std::optional<DualSolution> with_friction(const double more, const Vector &feasible, const DualSolution *start)
      {
        const SlipLaw          with_more = law.scaled(more);
        const ProgressObserver count     = [this](Progress progress) { counted()(progress.step); };
        const AccuracyTest     none;
        ContactSolver          held(dual, with_more, options, friction, count, none);
        const bool             is_held = held.converges(feasible, start);
        solution.counts += held.solution.counts;
        multiplications_beside += held.solution.counts.hessian_multiplications;
        return is_held ? std::optional(std::move(held.solution)) : std::nullopt;
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

      bool                        is_no_overload = false; // more friction did not show that friction is too weak
      std::optional<DualSolution> nearby;                 // a solution with a little more friction
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
