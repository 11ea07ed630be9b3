// The dual problem without inequalities, and functions shared by linear and contact problems.
#pragma once

#include <slipstick/contact/dual_solution.h>
#include <slipstick/scene/scene.h>

namespace slipstick::contact
{
  /// d - F x~ with the scaling of the solvers, projected onto the kernel of G. Set to 0 if only rounding remains, e.g.
  /// if rigid motions of the bodies alone close the gaps. One multiplication by F; collective.
  tfeti::DistributedVector homogenised_load(const tfeti::DualProblem &dual, const tfeti::DistributedVector &start);

  /// Energy norm of closing the jumps r of displacements [mm]; sqrt(N mm). Collective.
  double residual_energy(const tfeti::DualProblem &dual, const tfeti::DistributedVector &r);

  /// Projected conjugate gradients on a problem without inequality rows.
  /// @param previous starting point, to be corrected to G x = e; null: none.
  /// @param is_accurate may end the solve before the tolerance is reached; may be empty. Collective.
  DualSolution solve_linear(const tfeti::DualProblem   &dual,
                            const scene::SolverOptions &options,
                            const ProgressObserver     &observer,
                            const DualSolution         *previous,
                            const AccuracyTest         &is_accurate);
} // namespace slipstick::contact
