#include <slipstick/contact/linear.h>
#include <slipstick/contact/refinement.h>
#include <slipstick/qp/face_solver.h>
#include <slipstick/qp/pcpg.h>
#include <slipstick/tfeti/face.h>

#include <cmath>

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
    // The same before the next load step.
    constexpr double tolerance_of_history = 1e-2;

    using Vector = tfeti::DistributedVector;
    using Store  = qp::DirectionStore<Vector>;

    /// Slipping rows whose bounds follow normal forces that may change.
    struct SlippingRows
    {
      std::vector<qp::Tie>  ties;
      std::vector<qp::Turn> turns; // in space, where the direction of slip is kept
    };

    /// @param x is put on the bounds of these rows.
    SlippingRows slipping_rows(const SlipLaw &law, const std::vector<bool> &free, Vector &x)
    {
      SlippingRows result;
      for (const auto &[node, bound, slope] : law.slipping_nodes(x, free))
        {
          double along = x.local_element(node.tangential), across = node.is_disc() ? x.local_element(node.second) : 0.;
          const double size = std::hypot(along, across);
          along /= size;
          across /= size;
          x.local_element(node.tangential) = along * bound;
          if (node.is_disc())
            {
              x.local_element(node.second) = across * bound;
              result.turns.push_back({node.tangential, node.second, along, across});
            }
          result.ties.push_back({node.tangential, node.normal, node.is_disc() ? slope : along * slope});
        }
      return result;
    }

    /// A step that closes gaps, and the counts of its solve.
    struct Closing
    {
      Vector     step;
      qp::Counts counts;
    };

    Closing without_ties(const tfeti::Face &face, const Vector &b, const double size, const qp::PcpgOptions &options)
    {
      const auto M = [&face](const auto &r, auto &z) { face.precondition(r, z); };
      auto result  = qp::pcpg(face, b, qp::PcpgStart<Vector>{qp::zero_like(b)}, {closing_tolerance, size}, options, M);
      return {std::move(result.x), result.counts};
    }

    /// With those directions of the store that change no held row and satisfy the ties.
    /// @param residual to be reached.
    Closing with_store(const tfeti::Face       &face,
                       const Vector            &b,
                       const double             residual,
                       const std::vector<bool> &free,
                       const SlippingRows      &slipping,
                       const bool               has_ties,
                       Store                   &store)
    {
      std::vector<bool> is_held(free);
      is_held.flip();
      for (const auto &tie : slipping.ties)
        is_held[tie.tied] = false;
      for (const auto &turn : slipping.turns) // across the force nothing changes
        is_held[turn.second] = false;
      const auto conditions = [&](const Vector &p) {
        std::vector<double> moved;
        for (std::size_t r = 0; r < is_held.size(); ++r)
          if (is_held[r])
            moved.push_back(p.local_element(r));
        Vector turned(p);
        qp::turn(slipping.turns, turned);
        for (const auto &tie : slipping.ties)
          moved.push_back(turned.local_element(tie.tied) - tie.factor * p.local_element(tie.to));
        for (const auto &turn : slipping.turns)
          moved.push_back(turned.local_element(turn.second));
        return moved;
      };
      const qp::FaceSolverOptions         options;
      qp::FaceSolver<Vector, tfeti::Face> solver(face, b, store, conditions, options, slipping.turns);
      solver.start(qp::zero_like(b), qp::zero_like(b));
      auto result = has_ties ? solver.solve_unsymmetric(residual) : solver.solve_symmetric(residual);
      return {std::move(result.x), result.counts};
    }
  } // namespace

  DualSolution solve_refined(tfeti::DualProblem           &dual,
                             const SlipLaw                &law,
                             const scene::SolverOptions   &options,
                             const scene::FrictionOptions &friction,
                             const ProgressObserver       &observer,
                             const DualSolution           *start,
                             const AccuracyTest           &is_accurate)
  {
    auto solution = solve(dual, law, options, friction, observer, start, is_accurate);
    if (!dual.is_approximate() || is_accurate || solution.status != qp::Status::converged)
      return solution;
    const double norm =
      solution.reference > 0 ? solution.reference : homogenised_load(dual, dual.particular()).l2_norm();
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

  qp::Counts close_gaps(const tfeti::DualProblem   &dual,
                        const SlipLaw              &law,
                        const std::vector<bool>    &free,
                        const qp::PcpgOptions      &options,
                        tfeti::Recovery            &recovery,
                        qp::DirectionStore<Vector> *store)
  {
    Vector             x        = recovery.multipliers;
    const SlippingRows slipping = slipping_rows(law, free, x);
    const auto         face     = dual.face(free, slipping.ties, slipping.turns);
    if (!face.is_regular())
      return {};
    const bool has_ties = dual.reduction().min(slipping.ties.empty() ? 1. : 0.) < 1;
    if (has_ties)
      {
        face.balance(x);
        x -= recovery.multipliers;
        tfeti::correct(dual, recovery, x, free);
      }
    auto b = tfeti::misfit(dual, recovery, free);
    b /= -dual.norm(); // F step = B u - c
    const double  size = tfeti::residual_norm(dual, b);
    Store         fresh(qp::FaceSolverOptions().max_iterations);
    const Closing closing = store || has_ties ? with_store(face,
                                                           b,
                                                           (store ? tolerance_of_history : closing_tolerance) * size,
                                                           free,
                                                           slipping,
                                                           has_ties,
                                                           store ? *store : fresh)
                                              : without_ties(face, b, size, options);
    tfeti::correct(dual, recovery, closing.step, free);
    return closing.counts;
  }
} // namespace slipstick::contact
