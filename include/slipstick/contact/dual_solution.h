// Result of a solve of the dual problem, and its observers.
#pragma once

#include <slipstick/qp/direction_store.h>
#include <slipstick/qp/types.h>
#include <slipstick/tfeti/dual_problem.h>

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace slipstick::contact
{
  struct DualSolution
  {
    qp::Status               status = qp::Status::converged;
    tfeti::DistributedVector multipliers; // [N], owned rows

    /// F x - d + G'a at the multipliers, over the norm of F [N], as Newton's method left it: gaps that stay open tell a
    /// later solve with the same rows which touch. None where another method ended.
    std::optional<tfeti::DistributedVector> gradient;

    std::vector<double> slip_bound; // [N], owned rows: the bounds that the multipliers keep
    std::vector<bool>   free;       // owned rows: the multiplier is strictly inside its bounds
    qp::Counts          counts;
    double              projected_gradient = 0; // |gP| / |P d|
    double              reference          = 0; // that the residuals are relative to
    double              weighted_reference = 0; // the same with the weights of DualProblem::residual_weights()
    double              largest_forces     = 0; // |multipliers| of all steps so far [N]
    double              largest_traction   = 0; // norm in L2 of a pair's, of all steps so far [sqrt(N MPa)]
    double              equality           = 0; // |G x - e| / |P d|, scaled
    unsigned long long  active_constraints = 0; // inequality rows at a bound, over all ranks
    std::string         algorithm;              // "smalbe", "semismooth newton", "pcg"
    unsigned int        fallbacks           = 0;
    unsigned int        friction_iterations = 0; // updates of the slip bounds
    double              bound_change        = 0; // their last relative change

    /// Products with F from this solve and those it started from; of use for any other solve with the same rows.
    std::shared_ptr<qp::DirectionStore<tfeti::DistributedVector>> directions;
  };

  /// Called with iterates whose multipliers (within their bounds), slip bounds and free rows are set: is the answer
  /// accurate enough? @p residual_energy: energy norm of closing the jumps before the multipliers were moved to their
  /// bounds [sqrt(N mm)], a first estimate of the algebraic error, which contact::check computes from the displacement.
  /// The same on every process.
  using AccuracyTest = std::function<bool(const DualSolution &iterate, const double residual_energy)>;

  /// A solver step, with the update of the slip bounds that it belongs to.
  struct Progress
  {
    qp::OuterStep step;
    unsigned int  friction_iteration = 0;
  };
  using ProgressObserver = std::function<void(const Progress &)>;
} // namespace slipstick::contact
