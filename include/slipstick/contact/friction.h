// Solution of the dual problem within the bounds of the contact laws; Coulomb friction as a fixed point of the slip
// bounds.
#pragma once

#include <slipstick/contact/dual_solution.h>
#include <slipstick/contact/slip_law.h>

namespace slipstick::contact
{
  /// Slip bound of every owned row [N] that does not depend on the pressure: Tresca bound times tributary area.
  /// @throws InputError on all ranks when a slip bound is negative. Collective.
  template <int dim>
  std::vector<double> slip_bounds(const scene::Scene<dim> &scene, const tfeti::DualProblem &dual, const double t);

  /// The options with `auto` resolved: pcg for linear scenes, semismooth Newton with the Dirichlet preconditioner for
  /// contact; no preconditioner for methods that do not use one.
  template <int dim>
  scene::SolverOptions resolved_options(const scene::Scene<dim> &scene);

  /// Solves min 1/2 x'F x - x'd, G x = e, within the bounds of the law; linear problems by projected conjugate
  /// gradients. Bounds that depend on the pressure are updated until their relative change is at most the tolerance in
  /// @p friction, with damping if they cycle. The returned status reports non-convergence. Collective.
  /// @param start solution of the previous load step (multipliers and reference), if any.
  /// @param is_accurate may end the solve before the tolerance is reached; not called while an outer loop updates
  /// bounds that depend on the pressure.
  /// @throws NoEquilibrium naming body and motion if no admissible multipliers balance the loads.
  DualSolution solve(const tfeti::DualProblem     &dual,
                     const SlipLaw                &law,
                     const scene::SolverOptions   &options,
                     const scene::FrictionOptions &friction,
                     const ProgressObserver       &observer,
                     const DualSolution           *start       = nullptr,
                     const AccuracyTest           &is_accurate = {});

  /// As above, with given slip bounds.
  DualSolution solve(const tfeti::DualProblem   &dual,
                     const std::vector<double>  &slip_bound,
                     const scene::SolverOptions &options,
                     const qp::Observer         &observer);
} // namespace slipstick::contact
