// Result of a solve of the dual problem, and its callbacks.
#pragma once

#include <slipstick/qp/direction_store.h>
#include <slipstick/qp/types.h>
#include <slipstick/scene/scene.h>
#include <slipstick/tfeti/dual_problem.h>

#include <functional>
#include <memory>
#include <optional>
#include <vector>

namespace slipstick::contact
{
  struct DualSolution
  {
    qp::Status               status = qp::Status::converged;
    tfeti::DistributedVector multipliers; // [N], owned rows

    /// (F x - d + G'a) / |F| at the multipliers [N], as left by Newton's method: the gaps of open rows help a later
    /// solve with the same rows to predict the active set. Not set if another method finished the solve.
    std::optional<tfeti::DistributedVector> gradient;

    std::vector<double> slip_bound; // [N], owned rows: bounds satisfied by the multipliers
    std::vector<bool>   free;       // owned rows: the multiplier is strictly inside its bounds
    qp::Counts          counts;
    double              projected_gradient  = 0; // |gP| / |P d|
    double              reference           = 0; // reference value of the residuals
    double              weighted_reference  = 0; // the same with the weights of DualProblem::residual_weights()
    double              largest_forces      = 0; // |multipliers| of all steps so far [N]
    double              largest_traction    = 0; // L2 norm over a pair, maximum of all steps so far [sqrt(N MPa)]
    double              equality            = 0; // |G x - e| / |P d|, scaled
    unsigned long long  active_constraints  = 0; // inequality rows at a bound, over all ranks
    scene::Algorithm    algorithm           = scene::Algorithm::automatic; // that was used; not automatic
    unsigned int        fallbacks           = 0;
    unsigned int        friction_iterations = 0; // updates of the slip bounds
    double              bound_change        = 0; // relative change in the last update

    /// Products with F computed in this and earlier solves; can be reused by any other solve with the same rows.
    std::shared_ptr<qp::DirectionStore<tfeti::DistributedVector>> directions;
  };

  /// Called with iterates whose multipliers (within their bounds), slip bounds and free rows are set; returns whether
  /// the solution is accurate enough, the same on every process.
  /// @p residual_energy: energy norm of closing the jumps before the multipliers were moved to their bounds [sqrt(N
  /// mm)], a first estimate of the algebraic error, which contact::check computes from the displacement.
  using AccuracyTest = std::function<bool(const DualSolution &iterate, const double residual_energy)>;

  /// A solver step, with the number of the slip bound update in which it was made.
  struct Progress
  {
    qp::OuterStep step;
    unsigned int  friction_iteration = 0;
  };
  using ProgressObserver = std::function<void(const Progress &)>;
} // namespace slipstick::contact
