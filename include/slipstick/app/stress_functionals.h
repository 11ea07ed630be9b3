// The stresses that may have error bars, as linear functionals of displacements.
#pragma once

#include <slipstick/app/functionals.h>

namespace slipstick::app
{
  /// The largest von Mises stress and the stresses at point probes, linearised at the solution of the last load step. What
  /// the adjoint problem sees is the mean stress of the cells at a point (an infinite load otherwise); the rest of the
  /// error of the recovered stress is Functional::local_error.
  /// @param acting point supports and point loads that bear something. @param peaks of contact. @param quantities those that
  /// are needed; empty: all that differ. Collective.
  template <int dim>
  std::vector<Functional> stress_functionals(const StepSolver<dim>                            &solver,
                                             const mechanics::Probes<dim>                     &probes,
                                             const StepSolution                               &answer,
                                             const std::vector<mechanics::SingularPoint<dim>> &acting,
                                             const std::vector<mechanics::Surroundings<dim>>  &peaks,
                                             const double                                      t,
                                             const std::vector<std::string>                   &quantities);
} // namespace slipstick::app
