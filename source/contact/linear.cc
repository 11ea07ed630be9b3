#include <slipstick/contact/linear.h>
#include <slipstick/contact/traction_error.h>
#include <slipstick/qp/pcpg.h>
#include <slipstick/tfeti/diagnosis.h>
#include <slipstick/tfeti/face.h>

#include <cmath>

namespace slipstick::contact
{
  namespace
  {
    using Vector = tfeti::DistributedVector;

    // With an accuracy test, linear problems are solved in stages, each to this fraction of the previous residual ...
    constexpr double part_of_residual = 0.3;
    // ... starting with this residual.
    constexpr double first_asked = 0.1;
  } // namespace

  tfeti::DistributedVector homogenised_load(const tfeti::DualProblem &dual, const tfeti::DistributedVector &start)
  {
    Vector b = dual.zero(), q = dual.zero();
    dual.multiply(start, b);
    const double of_forces = tfeti::weighted_norm(dual, b);
    b.sadd(-1., 1. / dual.norm(), dual.d());
    const double all = std::hypot(of_forces, tfeti::weighted_norm(dual, b));
    dual.project_range(b, q);
    b -= q;
    if (tfeti::weighted_norm(dual, b) <= tfeti::rounding_of_projection * all)
      b = 0.;
    return b;
  }

  double residual_energy(const tfeti::DualProblem &dual, const Vector &r)
  {
    std::vector<bool> held(r.locally_owned_size());
    for (unsigned int i = 0; i < held.size(); ++i)
      held[i] = tfeti::is_equality(dual.constraints().kind[i]) || r.local_element(i) != 0;
    return std::sqrt(tfeti::jump_energies(dual, r, held).of_body.sum());
  }

  DualSolution solve_linear(const tfeti::DualProblem   &dual,
                            const scene::SolverOptions &options,
                            const ProgressObserver     &observer,
                            const DualSolution         *previous,
                            const AccuracyTest         &is_accurate)
  {
    Vector       start = dual.particular();
    DualSolution solution;
    solution.free          = std::vector<bool>(start.locally_owned_size(), true);
    solution.slip_bound    = std::vector<double>(start.locally_owned_size(), 0.);
    solution.algorithm     = scene::Algorithm::pcg;
    const auto   face      = dual.face(solution.free);
    auto         b         = homogenised_load(dual, start);
    const double reference = tfeti::residual_norm(dual, b);
    if (reference == 0) // no deformation
      {
        solution.multipliers = start;
        solution.status      = qp::Status::converged;
        ++solution.counts.hessian_multiplications;
        return solution;
      }
    const auto precondition = [&face](const Vector &r, Vector &z) { face.precondition(r, z); };
    if (previous) // continue from the true residual instead of the recursion of an earlier solve
      {
        start = previous->multipliers;
        face.balance(start);
        b = homogenised_load(dual, start);
        ++solution.counts.hessian_multiplications;
      }
    const qp::Observer counted = [&](qp::OuterStep step) {
      step.hessian_multiplications += 1 + solution.counts.hessian_multiplications; // F x~ in the homogenised load
      step.outer += solution.counts.cg_steps;
      if (observer)
        observer({step, 0});
    };
    qp::PcpgOptions       pcpg              = options.pcpg;
    const bool            is_preconditioned = dual.preconditioner() != nullptr;
    bool                  reorthogonalizes  = is_preconditioned;
    qp::PcpgStart<Vector> from{dual.zero()};
    if (is_accurate) // stages continue with the directions of the previous ones
      from.history = std::make_shared<qp::DirectionHistory<Vector>>(is_preconditioned);
    double             tolerance = is_accurate ? std::max(first_asked, options.tolerance) : options.tolerance;
    const TractionTest tractions(dual,
                                 options.tolerance,
                                 start.linfty_norm(),
                                 previous ? previous->largest_traction : 0.);
    const auto         are_tractions_accurate = [&](const Vector &residual) {
      if (!tractions.has_pairs())
        return true;
      Vector error = dual.zero();
      face.precondition(residual, error);
      ++solution.counts.preconditioner_applications;
      face.project_kernel(error);
      return tractions.accepts(solution.multipliers, error);
    };
    if (tractions.has_pairs() && !from.history)
      from.history = std::make_shared<qp::DirectionHistory<Vector>>(is_preconditioned);
    bool has_met_goal = false;
    for (;; tolerance = std::max(has_met_goal ? 0. : options.tolerance, part_of_residual * tolerance))
      {
        const qp::Goal goal(tolerance, reference);
        auto           result = is_preconditioned ? qp::pcpg(face, b, from, goal, pcpg, precondition, counted)
                                                  : qp::pcpg(face, b, from, goal, pcpg, qp::NoPreconditioner(), counted);
        solution.counts += result.counts;
        if (has_met_goal && result.status != qp::Status::converged) // the point that met the goal is at rounding level
          break;
        solution.status             = result.status;
        solution.projected_gradient = result.relative_residual;
        solution.multipliers        = start;
        solution.multipliers += result.x;
        if (result.status == qp::Status::stagnated && !reorthogonalizes)
          { // rounding has destroyed the conjugacy of the directions
            reorthogonalizes         = true;
            pcpg.reorthogonalization = qp::Reorthogonalization::full;
            from                     = {std::move(result.x)};
            tolerance /= part_of_residual; // repeat the stage
            continue;
          }
        if (result.status != qp::Status::converged)
          break;
        has_met_goal = tolerance <= options.tolerance;
        if (has_met_goal)
          {
            if (tolerance <= options.newton.least_part * options.tolerance || are_tractions_accurate(result.residual))
              break;
          }
        else
          {
            Vector jumps = std::move(result.residual);
            jumps *= dual.norm();
            if (is_accurate(solution, residual_energy(dual, jumps)))
              break;
          }
        from.x       = std::move(result.x);
        from.product = std::move(result.product);
      }
    ++solution.counts.hessian_multiplications; // F x~ in the homogenised load
    solution.counts.outer_iterations = 1;
    solution.largest_traction        = tractions.largest(solution.multipliers);
    return solution;
  }
} // namespace slipstick::contact
