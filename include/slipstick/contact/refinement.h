// Solutions more accurate than rounding of the dual operator and the multipliers allows.
#pragma once

#include <slipstick/contact/friction.h>

namespace slipstick::contact
{
  /// As solve(). With a dual operator F~ in single precision the solution is corrected until it solves the problem with
  /// the F of double precision to the same tolerance: the load takes up the error (F - F~) x at the solution x, from
  /// where the solver goes on, with the same bounds on x. Every correction reduces the error by some six digits. On
  /// return `projected_gradient` holds for F. What @p is_accurate accepts is not corrected. Collective.
  DualSolution solve_refined(tfeti::DualProblem           &dual,
                             const SlipLaw                &law,
                             const scene::SolverOptions   &options,
                             const scene::FrictionOptions &friction,
                             const ProgressObserver       &observer,
                             const DualSolution           *start       = nullptr,
                             const AccuracyTest           &is_accurate = {});

  /// Closes what the free rows of a recovered solution leave open by a linear solve of its own, relative to that: u is
  /// corrected, not computed anew from x. So it gets past the last digit of x, which slender subdomains turn into
  /// displacements far above those that are looked for (a strip of length L and height h bends (L/h)^2 times as much as it
  /// yields, and more). The set stays; bodies that slide on all their contacts are left alone. Collective.
  /// @return the work.
  qp::Counts close_gaps(const tfeti::DualProblem     &dual,
                        const std::vector<bool>      &free,
                        const qp::PcpgOptions        &options,
                        tfeti::DualProblem::Recovery &recovery);
} // namespace slipstick::contact
