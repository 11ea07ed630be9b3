#include <slipstick/contact/refinement.h>
#include <slipstick/qp/pcpg.h>
#include <slipstick/tfeti/face.h>

namespace slipstick::contact
{
  namespace
  {
    // Maximum number of corrections; two are enough to reach rounding.
    constexpr unsigned int max_corrections = 5;
    // Multiplications needed to measure the error of F~.
    constexpr unsigned int multiplications_per_check = 2;
    // Tolerance for closing the gaps, relative to the gaps; rounding of F prevents less in slender subdomains.
    constexpr double closing_tolerance = 1e-4;
  } // namespace

  DualSolution solve_refined(tfeti::DualProblem           &dual,
                             const SlipLaw                &law,
                             const scene::SolverOptions   &options,
                             const scene::FrictionOptions &friction,
                             const ProgressObserver       &observer,
                             const DualSolution           *start,
                             const AccuracyTest           &is_accurate)
  {
    auto       solution  = solve(dual, law, options, friction, observer, start, is_accurate);
    const auto reference = [&dual] { // |P (d - F x~)|, as in the solvers
      auto x = dual.particular(), b = dual.zero(), q = dual.zero();
      dual.multiply(x, b);
      b.sadd(-1., 1. / dual.norm(), dual.d());
      dual.project_range(b, q);
      b -= q;
      return b.l2_norm();
    };
    if (!dual.is_approximate() || is_accurate || solution.status != qp::Status::converged)
      return solution;
    const double norm = solution.reference > 0 ? solution.reference : reference();
    for (unsigned int correction = 0;; ++correction)
      {
        const double change = norm > 0 ? dual.refine(solution.multipliers) / norm : 0.;
        solution.counts.hessian_multiplications += multiplications_per_check;
        solution.projected_gradient += change; // triangle inequality
        if (solution.projected_gradient <= options.tolerance)
          return solution;
        if (correction == max_corrections)
          {
            solution.status = qp::Status::stagnated;
            return solution;
          }
        const DualSolution before = std::move(solution);

        solution = solve(
          dual,
          law,
          options,
          friction,
          [&](Progress progress) {
            progress.step.hessian_multiplications += before.counts.hessian_multiplications;
            progress.step.outer += before.counts.outer_iterations;
            if (observer)
              observer(progress);
          },
          &before);
        solution.counts += before.counts;
        solution.fallbacks += before.fallbacks;
        solution.friction_iterations += before.friction_iterations;
        if (solution.status != qp::Status::converged)
          return solution;
      }
  }

  qp::Counts close_gaps(const tfeti::DualProblem &dual,
                        const std::vector<bool>  &free,
                        const qp::PcpgOptions    &options,
                        tfeti::Recovery          &recovery)
  {
    const auto face = dual.face(free);
    if (!face.is_regular())
      return {};
    auto b = tfeti::misfit(dual, recovery, free);
    b /= -dual.norm(); // F step = B u - c
    const auto result = qp::pcpg(face,
                                 b,
                                 qp::PcpgStart<tfeti::DistributedVector>{dual.zero()},
                                 qp::Goal(closing_tolerance, tfeti::residual_norm(dual, b)),
                                 options,
                                 [&face](const auto &r, auto &z) { face.precondition(r, z); });
    tfeti::correct(dual, recovery, result.x, free);
    return result.counts;
  }
} // namespace slipstick::contact
