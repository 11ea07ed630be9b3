// The stresses that may have error bars, as linear functionals of displacements.
#pragma once

#include <slipstick/app/functionals.h>

namespace slipstick::app
{
  /// The largest von Mises stress and the stresses at point probes, linearised at the solution of the last load step.
  /// The adjoint problem is that of the mean stress of the cells at a point, since the load of a point value has
  /// infinite energy; the rest of the error of the recovered stress is Functional::local_error.
  /// @param acting point supports and point loads whose force is not negligible.
  /// @param peaks peaks of the contact pressure.
  /// @param requested the quantities needed; unless it is a goal, max_regular_von_mises only if max_von_mises has no
  /// error bar because of a singular point.
  /// Collective.
  template <int dim>
  std::vector<Functional> stress_functionals(const StepSolver<dim>                            &solver,
                                             const mechanics::Probes<dim>                     &probes,
                                             const StepSolution                               &answer,
                                             const std::vector<mechanics::SingularPoint<dim>> &acting,
                                             const std::vector<mechanics::Surroundings<dim>>  &peaks,
                                             const double                                      t,
                                             const RequestedBars                              &requested);
} // namespace slipstick::app
