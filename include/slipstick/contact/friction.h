// The dual problem solved within the bounds of the contact laws; Coulomb friction as a fixed point of the slip bounds.
#pragma once

#include <slipstick/contact/slip_law.h>
#include <slipstick/qp/types.h>

namespace slipstick::contact
{
  /// Slip bound of every owned row [N] that does not depend on the pressure: Tresca bound times tributary area.
  /// @throws InputError on all ranks when a slip bound is negative. Collective.
  template <int dim>
  std::vector<double> slip_bounds(const scene::Scene<dim> &scene, const tfeti::DualProblem &dual, const double t);

  struct DualSolution
  {
    qp::Status               status = qp::Status::converged;
    tfeti::DistributedVector multipliers; // [N], owned rows
    std::vector<double>      slip_bound;  // [N], owned rows: the bounds that the multipliers keep
    std::vector<bool>        free;        // owned rows: the multiplier is strictly inside its bounds
    qp::Counts               counts;
    double                   projected_gradient = 0; // |gP| / |P d|
    double                   reference          = 0; // that the residuals are relative to
    double                   weighted_reference = 0; // the same with the weights of DualProblem::residual_weights()
    double                   equality           = 0; // |G x - e| / |P d|, scaled
    unsigned long long       active_constraints = 0; // inequality rows at a bound, over all ranks
    std::string              algorithm;              // "smalbe", "semismooth newton", "pcg"
    unsigned int             fallbacks           = 0;
    unsigned int             friction_iterations = 0; // updates of the slip bounds
    double                   bound_change        = 0; // their last relative change
  };

  /// Asked about iterates, of which multipliers (within their bounds), slip bounds and free rows are filled: is the answer
  /// accurate enough? @p residual_energy: energy norm of what closes the jumps before the multipliers were moved to their
  /// bounds [sqrt(N mm)], a first idea of the algebraic error; contact::check tells it from the displacement. The same on
  /// every process.
  using AccuracyTest = std::function<bool(const DualSolution &iterate, const double residual_energy)>;

  /// The options with `auto` resolved: pcg for linear scenes, semismooth Newton with the Dirichlet preconditioner for
  /// contact; no preconditioner where there is no use for one.
  template <int dim>
  scene::SolverOptions resolved_options(const scene::Scene<dim> &scene);

  /// A solver step, with the update of the slip bounds that it belongs to.
  struct Progress
  {
    qp::OuterStep step;
    unsigned int  friction_iteration = 0;
  };
  using ProgressObserver = std::function<void(const Progress &)>;

  /// Solves min 1/2 x'F x - x'd, G x = e, within the bounds of the law; linear problems by projected conjugate gradients.
  /// Bounds that depend on the pressure are followed until their relative change is at most that of @p friction, damped
  /// when they cycle. Non-convergence is in the status. Collective.
  /// @param start of the load step before (multipliers and reference), if any.
  /// @param is_accurate ends the solve before the tolerance is reached; not asked while bounds that depend on the pressure
  /// are followed in an outer loop.
  /// @throws NoEquilibrium naming body and motion when no multipliers that the law admits balance the loads.
  DualSolution solve(const tfeti::DualProblem     &dual,
                     const SlipLaw                &law,
                     const scene::SolverOptions   &options,
                     const scene::FrictionOptions &friction,
                     const ProgressObserver       &observer,
                     const DualSolution           *start       = nullptr,
                     const AccuracyTest           &is_accurate = {});

  /// The same with given slip bounds.
  DualSolution solve(const tfeti::DualProblem   &dual,
                     const std::vector<double>  &slip_bound,
                     const scene::SolverOptions &options,
                     const qp::Observer         &observer);
} // namespace slipstick::contact
