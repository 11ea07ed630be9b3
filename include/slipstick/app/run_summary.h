// What a run says in summary.json, and whether its answer passes.
#pragma once

#include <slipstick/contact/checks.h>
#include <slipstick/contact/friction.h>
#include <slipstick/mechanics/stress.h>
#include <slipstick/output/summary.h>

namespace slipstick::app
{
  // A check may exceed the solver's tolerance by this factor (checks compare with displacements and forces, the
  // tolerance with |Pd|), but never this part of the answer.
  constexpr double check_factor  = 1000;
  constexpr double largest_limit = 0.05;

  /// The tolerance of a solution: that of the options, or with Tolerance = auto the residual at which it was accepted.
  double tolerance_of(const scene::SolverOptions &options, const contact::DualSolution &solution);

  /// Checks above this limit do not count as converged.
  double check_limit(const double tolerance);

  /// Did the solver converge, and are all checks within the limit?
  bool passes(const contact::DualSolution &solution, const contact::Checks &checks, const double tolerance);

  /// Case, version, ranks.
  template <int dim>
  output::Summary empty_summary(const scene::Scene<dim> &scene, const MPI_Comm comm);

  /// Appends the step that @p summary describes to the previous ones: counts are summed, the worst residuals kept.
  void add_step(const output::Summary &so_far, const double load_factor, output::Summary &summary);

  /// Forces around a circumference have no moment: of bodies of revolution all moments become 0.
  template <int dim>
  void drop_moments(const scene::Scene<dim> &scene, output::ResultSummary &results);

  /// Everything in summary.json but times and memory.
  template <int dim>
  output::Summary make_summary(const scene::Scene<dim>       &scene,
                               const mesh::Mesh<dim>         &mesh,
                               const mechanics::Spaces<dim>  &spaces,
                               const tfeti::DualProblem      &dual,
                               const contact::DualSolution   &solution,
                               const contact::Checks         &checks,
                               const mechanics::StressResult &stress);
} // namespace slipstick::app
