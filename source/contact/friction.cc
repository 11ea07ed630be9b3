#include <slipstick/base/collective.h>
#include <slipstick/base/exceptions.h>
#include <slipstick/base/log.h>
#include <slipstick/contact/friction.h>
#include <slipstick/qp/feasible_point.h>
#include <slipstick/qp/pcpg.h>
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
        "no contact forces within their bounds balance the loads: they set in motion " +
          tfeti::describe(dual.motion_behind(certificate), dual.body_names()),
        "support the body against this motion, raise the slip bound, or turn the loads towards the contact");
    }

    DualSolution solve_linear(const tfeti::DualProblem   &dual,
                              const scene::SolverOptions &options,
                              const qp::Observer         &observer)
    {
      Vector start  = dual.particular();
      auto   result = qp::pcpg(dual,
                             homogenised_load(dual, start),
                             qp::PcpgStart<Vector>{dual.zero()},
                             qp::Goal(options.tolerance),
                             options.pcpg);
      start += result.x;
      DualSolution solution;
      solution.status             = result.status;
      solution.multipliers        = start;
      solution.free               = std::vector<bool>(start.locally_owned_size(), true);
      solution.counts             = result.counts;
      solution.projected_gradient = result.relative_residual;
      solution.algorithm          = "pcg";
      ++solution.counts.hessian_multiplications; // F x~ in the homogenised load
      solution.counts.outer_iterations = 1;
      if (observer)
        observer({1, solution.counts.hessian_multiplications, result.relative_residual, 0., 0, 0});
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

    const Box  box   = multiplier_box(dual, slip_bound);
    const auto start = qp::feasible_point(dual, dual.particular(), box);
    if (start.status == qp::Status::infeasible)
      no_equilibrium(dual, start.certificate);

    const auto with_start = [&observer](qp::OuterStep step) {
      ++step.hessian_multiplications; // F x~ in the homogenised load
      if (observer)
        observer(step);
    };
    Box shifted = box;
    shifted.lower -= start.x;
    shifted.upper -= start.x;
    auto         result = qp::smalbe(dual,
                             1.,
                             homogenised_load(dual, start.x),
                             shifted,
                             qp::SmalbeStart<Vector>{dual.zero()},
                             qp::Goal(options.tolerance),
                             options.smalbe,
                             with_start);
    DualSolution solution;
    solution.status             = result.status;
    solution.counts             = result.counts;
    solution.projected_gradient = result.projected_gradient;
    solution.equality           = result.equality_residual;
    solution.algorithm          = "smalbe";
    solution.multipliers        = start.x;
    solution.multipliers += result.x;
    // entries that reached a shifted bound are put on the bound itself, to the last bit
    for (unsigned int r = 0; r < solution.multipliers.locally_owned_size(); ++r)
      if (result.x.local_element(r) <= shifted.lower.local_element(r))
        solution.multipliers.local_element(r) = box.lower.local_element(r);
      else if (result.x.local_element(r) >= shifted.upper.local_element(r))
        solution.multipliers.local_element(r) = box.upper.local_element(r);
    ++solution.counts.hessian_multiplications; // F x~
    find_active(box, dual.communicator(), solution);
    return solution;
  }

  template std::vector<double> slip_bounds(const scene::Scene<2> &, const tfeti::DualProblem &, const double);
} // namespace slipstick::contact
