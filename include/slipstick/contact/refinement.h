// Solutions more accurate than rounding of the dual operator and the multipliers allows.
#pragma once

#include <slipstick/contact/friction.h>
#include <slipstick/tfeti/recovery.h>

namespace slipstick::contact
{
  /// As solve(). With a dual operator F~ in single precision the solution is corrected until it solves the problem with
  /// the F of double precision to the same tolerance: the error (F - F~) x at the solution x is added to the load, and
  /// the solver continues from x with the same bounds. Every correction reduces the error by some six digits. On return
  /// `projected_gradient` holds for F. Solutions that @p is_accurate accepts are not corrected. Collective.
  DualSolution solve_refined(tfeti::DualProblem           &dual,
                             const SlipLaw                &law,
                             const scene::SolverOptions   &options,
                             const scene::FrictionOptions &friction,
                             const ProgressObserver       &observer,
                             const DualSolution           *start       = nullptr,
                             const AccuracyTest           &is_accurate = {});

  /// Closes the remaining jumps of the free rows of a recovered solution by a separate linear solve, with a tolerance
  /// relative to these jumps: u is corrected, not computed again from x. This overcomes the last digit of x, which
  /// slender subdomains turn into displacements far above those sought (a strip of length L and height h bends at least
  /// (L/h)^2 times as much as it stretches). The set stays; bodies that slide on all their contacts are left alone.
  /// Collective.
  /// @return the work.
  qp::Counts close_gaps(const tfeti::DualProblem &dual,
                        const std::vector<bool>  &free,
                        const qp::PcpgOptions    &options,
                        tfeti::Recovery          &recovery);
} // namespace slipstick::contact
