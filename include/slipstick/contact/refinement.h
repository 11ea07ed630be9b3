// Solutions in double precision from a dual operator stored in single precision.
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
} // namespace slipstick::contact
