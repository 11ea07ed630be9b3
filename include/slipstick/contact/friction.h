// Bounds of the multipliers from the contact laws, and the solution of the dual problem within them.
#pragma once

#include <slipstick/qp/box.h>
#include <slipstick/qp/types.h>
#include <slipstick/scene/scene.h>
#include <slipstick/tfeti/dual_problem.h>

namespace slipstick::contact
{
  using Box = qp::Box<tfeti::DistributedVector>;

  /// Slip bound of every owned row [N]: Tresca bound times tributary area for tangential rows, 0 for the others.
  /// @throws InputError on all ranks when a slip bound is negative. Collective.
  template <int dim>
  std::vector<double> slip_bounds(const scene::Scene<dim> &scene, const tfeti::DualProblem &dual, const double t);

  /// Bounds of the multipliers: normal >= 0, |tangential| <= slip bound, equality rows free [N].
  Box multiplier_box(const tfeti::DualProblem &dual, const std::vector<double> &slip_bound);

  struct DualSolution
  {
    qp::Status               status = qp::Status::converged;
    tfeti::DistributedVector multipliers; // [N], owned rows
    std::vector<bool>        free;        // owned rows: the multiplier is strictly inside its bounds
    qp::Counts               counts;
    double                   projected_gradient = 0; // |gP| / |P d|
    double                   reference          = 0; // that the residuals are relative to
    double                   equality           = 0; // |G x - e| / |P d|, scaled
    unsigned long long       active_constraints = 0; // inequality rows at a bound, over all ranks
    std::string              algorithm;              // "smalbe", "pcg"
    unsigned int             fallbacks = 0;
  };

  /// The options with `auto` resolved: pcg for linear scenes, smalbe for contact (semismooth Newton if a
  /// preconditioner is asked for); Dirichlet preconditioner for
  /// semismooth Newton, none where there is no use for one.
  template <int dim>
  scene::SolverOptions resolved_options(const scene::Scene<dim> &scene);

  /// Solves min 1/2 x'F x - x'd, G x = e, within the bounds; linear problems by projected conjugate gradients.
  /// Non-convergence is in the status. Collective.
  /// @throws NoEquilibrium naming body and motion when no multipliers within the bounds balance the loads.
  DualSolution solve(const tfeti::DualProblem   &dual,
                     const std::vector<double>  &slip_bound,
                     const scene::SolverOptions &options,
                     const qp::Observer         &observer);
} // namespace slipstick::contact
