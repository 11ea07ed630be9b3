// Iterative refinement beyond the rounding of the dual operator and of the multipliers.
#pragma once

#include <slipstick/contact/friction.h>
#include <slipstick/tfeti/recovery.h>

namespace slipstick::contact
{
  /// As solve(). If the dual operator is stored in single precision (F~), the solution is corrected until it solves the
  /// problem with F in double precision to the same tolerance: the error (F - F~) x at the solution x is added to the
  /// load, and the solver continues from x with the same bounds. Every correction reduces the error by about six
  /// digits. On return `projected_gradient` holds for F. Solutions accepted by @p is_accurate are not corrected.
  /// Collective.
  DualSolution solve_refined(tfeti::DualProblem           &dual,
                             const SlipLaw                &law,
                             const scene::SolverOptions   &options,
                             const scene::FrictionOptions &friction,
                             const ProgressObserver       &observer,
                             const DualSolution           *start       = nullptr,
                             const AccuracyTest           &is_accurate = {});

  /// Closes the remaining jumps of the free rows of a recovered solution by a separate linear solve, with a tolerance
  /// relative to these jumps: u is corrected, not recomputed from x. This avoids the effect of the last digit of x,
  /// which in slender subdomains causes displacements far larger than the required accuracy (a strip of length L and
  /// height h is at least (L/h)^2 times as compliant in bending as in tension). The active set is unchanged, and slip
  /// forces follow the normal forces according to the law; in space their directions are kept. Bodies that slide on all
  /// their contacts are not corrected.
  /// Collective.
  /// @param store directions of earlier solves, which are used and extended; the tolerance is then only 1e-2. Null: none.
  /// @return counts of the solve.
  qp::Counts close_gaps(const tfeti::DualProblem                     &dual,
                        const SlipLaw                                &law,
                        const std::vector<bool>                      &free,
                        const qp::PcpgOptions                        &options,
                        tfeti::Recovery                              &recovery,
                        qp::DirectionStore<tfeti::DistributedVector> *store = nullptr);
} // namespace slipstick::contact
