#include <slipstick/base/collective.h>
#include <slipstick/base/exceptions.h>
#include <slipstick/base/log.h>
#include <slipstick/contact/friction.h>
#include <slipstick/qp/feasible_point.h>
#include <slipstick/qp/pcpg.h>
#include <slipstick/qp/semismooth_newton.h>
#include <slipstick/qp/smalbe.h>
#include <slipstick/tfeti/rigid_motions.h>

#include <deal.II/base/mpi.h>

#include <limits>

namespace slipstick::contact
{
  namespace
  {
    using Vector = tfeti::DistributedVector;

    constexpr double infinity = std::numeric_limits<double>::infinity();

    /// b - F x~ scaled as the solvers see it, projected on the kernel of G.
    Vector homogenised_load(const tfeti::DualProblem &dual, const Vector &start)
    {
      Vector b = dual.zero(), q = dual.zero();
      dual.multiply(start, b);
      b.sadd(-1., 1. / dual.norm(), dual.d());
      dual.project_range(b, q);
      b -= q;
      return b;
    }

    [[noreturn]] void no_equilibrium(const tfeti::DualProblem &dual, const Vector &certificate)
    {
      throw NoEquilibrium(
        "no contact forces within their bounds balance the loads, which move " +
          tfeti::describe(dual.motion_behind(certificate), dual.body_names()),
        "support the body against this motion, raise the slip bound, or turn the loads towards the contact");
    }

    DualSolution solve_linear(const tfeti::DualProblem   &dual,
                              const scene::SolverOptions &options,
                              const qp::Observer         &observer)
    {
      Vector       start = dual.particular();
      DualSolution solution;
      solution.free                    = std::vector<bool>(start.locally_owned_size(), true);
      solution.algorithm               = "pcg";
      const auto                  face = dual.face(solution.free);
      const auto                  b    = homogenised_load(dual, start);
      const qp::PcpgStart<Vector> from_zero{dual.zero()};
      const auto                  precondition = [&face](const Vector &r, Vector &z) { face.precondition(r, z); };
      const qp::Observer          counted      = [&observer](qp::OuterStep step) {
        ++step.hessian_multiplications; // F x~ in the homogenised load
        if (observer)
          observer(step);
      };
      const qp::Goal goal(options.tolerance);
      const auto     result = dual.is_preconditioned()
                                ? qp::pcpg(dual, b, from_zero, goal, options.pcpg, precondition, counted)
                                : qp::pcpg(dual, b, from_zero, goal, options.pcpg, qp::NoPreconditioner(), counted);
      start += result.x;
      solution.status             = result.status;
      solution.multipliers        = start;
      solution.counts             = result.counts;
      solution.projected_gradient = result.relative_residual;
      ++solution.counts.hessian_multiplications; // F x~ in the homogenised load
      solution.counts.outer_iterations = 1;
      return solution;
    }

    /// Inequality rows at a bound; fills `free` of the owned rows.
    void find_active(const Box &box, const MPI_Comm comm, DualSolution &solution)
    {
      unsigned long long n = 0;
      solution.free.resize(solution.multipliers.locally_owned_size());
      for (unsigned int r = 0; r < solution.free.size(); ++r)
        {
          const double x   = solution.multipliers.local_element(r);
          solution.free[r] = x > box.lower.local_element(r) && x < box.upper.local_element(r);
          n += !solution.free[r];
        }
      solution.active_constraints = dealii::Utilities::MPI::sum(n, comm);
    }

    /// SMALBE-M from the point @p from within the bounds. @param reference of the residuals; 0: |P(d - F from)|.
    DualSolution solve_smalbe(const tfeti::DualProblem   &dual,
                              const Box                  &box,
                              const Vector               &from,
                              const double                tolerance,
                              const double                reference,
                              const scene::SolverOptions &options,
                              const qp::Observer         &observer)
    {
      const auto with_start = [&observer](qp::OuterStep step) {
        ++step.hessian_multiplications; // F x~ in the homogenised load
        if (observer)
          observer(step);
      };
      Box shifted = box;
      shifted.lower -= from;
      shifted.upper -= from;
      const auto   result = qp::smalbe(dual,
                                     1.,
                                     homogenised_load(dual, from),
                                     shifted,
                                     qp::SmalbeStart<Vector>{dual.zero()},
                                     qp::Goal(tolerance, reference),
                                     options.smalbe,
                                     with_start);
      DualSolution solution;
      solution.status             = result.status;
      solution.counts             = result.counts;
      solution.projected_gradient = result.projected_gradient;
      solution.equality           = result.equality_residual;
      solution.reference          = result.reference;
      solution.algorithm          = "smalbe";
      solution.multipliers        = from;
      solution.multipliers += result.x;
      // entries that reached a shifted bound are put on the bound itself, to the last bit
      for (unsigned int r = 0; r < solution.multipliers.locally_owned_size(); ++r)
        if (result.x.local_element(r) <= shifted.lower.local_element(r))
          solution.multipliers.local_element(r) = box.lower.local_element(r);
        else if (result.x.local_element(r) >= shifted.upper.local_element(r))
          solution.multipliers.local_element(r) = box.upper.local_element(r);
      ++solution.counts.hessian_multiplications; // F x~ in the homogenised load
      find_active(box, dual.communicator(), solution);
      return solution;
    }

    /// A few steps of SMALBE-M for the first active set, semismooth Newton from there, SMALBE-M again if it stalls.
    DualSolution solve_newton(const tfeti::DualProblem   &dual,
                              const Box                  &box,
                              Vector                      from,
                              const scene::SolverOptions &options,
                              const qp::Observer         &observer)
    {
      DualSolution solution  = solve_smalbe(dual, box, from, options.newton.start_tolerance, 0., options, {});
      const double reference = solution.reference;
      Vector       d         = dual.d();
      d /= dual.norm();
      const auto before  = solution.counts;
      const auto counted = [&](qp::OuterStep step) {
        step.hessian_multiplications += before.hessian_multiplications;
        if (observer)
          observer(step);
      };
      auto result = qp::semismooth_newton(dual,
                                          1.,
                                          d,
                                          box,
                                          solution.multipliers,
                                          qp::Goal(options.tolerance, reference),
                                          options.newton,
                                          options.pcpg,
                                          counted);
      solution.counts += result.counts;
      solution.counts.outer_iterations = result.counts.outer_iterations;
      solution.status                  = result.status;
      solution.algorithm               = "semismooth newton";
      solution.projected_gradient      = result.projected_gradient;
      solution.equality                = 0;
      solution.multipliers             = std::move(result.x);
      if (result.status == qp::Status::converged)
        {
          find_active(box, dual.communicator(), solution);
          return solution;
        }
      const auto so_far = solution.counts;
      solution          = solve_smalbe(dual, box, from, options.tolerance, reference, options, observer);
      solution.counts += so_far;
      solution.algorithm = "semismooth newton";
      solution.fallbacks = 1;
      return solution;
    }
  } // namespace

  template <int dim>
  std::vector<double> slip_bounds(const scene::Scene<dim> &scene, const tfeti::DualProblem &dual, const double t)
  {
    std::vector<double> bounds(dual.constraints().kind.size(), 0.);
    collectively(dual.communicator(), [&] {
      for (const auto &point : dual.constraints().contact_points)
        if (point.tangential_row != tfeti::invalid_row)
          {
            dealii::Point<dim> x;
            for (unsigned int d = 0; d < dim; ++d)
              x[d] = point.position[d];
            const auto  &contact = scene.contacts[point.pair];
            const double bound   = contact.slip_bound.value(x, t);
            if (!(bound >= 0 && std::isfinite(bound)))
              throw InputError(
                format("Contact %s/Slip bound is %g MPa at (%g, %g)", contact.name.c_str(), bound, x[0], x[1]),
                "it must be zero or positive everywhere on the slave boundary");
            bounds[point.tangential_row] = bound * point.area;
          }
    });
    return bounds;
  }

  template <int dim>
  scene::SolverOptions resolved_options(const scene::Scene<dim> &scene)
  {
    scene::SolverOptions options        = scene.solver;
    auto                &preconditioner = options.dual.preconditioner;
    if (options.algorithm == scene::Algorithm::automatic)
      {
        const bool preconditioned =
          preconditioner == tfeti::Preconditioner::lumped || preconditioner == tfeti::Preconditioner::dirichlet;
        options.algorithm = !scene.has_contact() ? scene::Algorithm::pcg
                            : preconditioned     ? scene::Algorithm::semismooth_newton
                                                 : scene::Algorithm::smalbe;
      }
    if (options.algorithm == scene::Algorithm::smalbe)
      preconditioner = tfeti::Preconditioner::none; // it would change the bounds
    else if (preconditioner == tfeti::Preconditioner::automatic)
      preconditioner = options.algorithm == scene::Algorithm::semismooth_newton ? tfeti::Preconditioner::dirichlet
                                                                                : tfeti::Preconditioner::none;
    return options;
  }

  Box multiplier_box(const tfeti::DualProblem &dual, const std::vector<double> &slip_bound)
  {
    Box box{dual.zero(), dual.zero()};
    for (unsigned int r = 0; r < dual.constraints().kind.size(); ++r)
      {
        double &lower = box.lower.local_element(r), &upper = box.upper.local_element(r);
        switch (dual.constraints().kind[r])
          {
            case tfeti::RowKind::tangential:
              lower = -slip_bound[r];
              upper = slip_bound[r];
              break;
            case tfeti::RowKind::normal:
              lower = 0;
              upper = infinity;
              break;
            case tfeti::RowKind::gluing:
            case tfeti::RowKind::prescribed:
              lower = -infinity;
              upper = infinity;
              break;
          }
      }
    return box;
  }

  DualSolution solve(const tfeti::DualProblem   &dual,
                     const std::vector<double>  &slip_bound,
                     const scene::SolverOptions &options,
                     const qp::Observer         &observer)
  {
    const auto &counts = dual.constraints().counts;
    if (counts.normal + counts.tangential == 0)
      return solve_linear(dual, options, observer);

    const Box box   = multiplier_box(dual, slip_bound);
    auto      start = qp::feasible_point(dual, dual.particular(), box);
    if (start.status == qp::Status::infeasible)
      no_equilibrium(dual, start.certificate);
    return options.algorithm == scene::Algorithm::semismooth_newton
             ? solve_newton(dual, box, std::move(start.x), options, observer)
             : solve_smalbe(dual, box, start.x, options.tolerance, 0., options, observer);
  }

  template scene::SolverOptions resolved_options(const scene::Scene<2> &);
  template std::vector<double>  slip_bounds(const scene::Scene<2> &, const tfeti::DualProblem &, const double);
} // namespace slipstick::contact
