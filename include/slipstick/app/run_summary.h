// Contents of summary.json, and the acceptance test of a solution.
#pragma once

#include <slipstick/contact/checks.h>
#include <slipstick/contact/friction.h>
#include <slipstick/mechanics/stress.h>
#include <slipstick/output/summary.h>

namespace slipstick::app
{
  // A check may exceed the solver's tolerance by this factor (checks refer to displacements and forces, the tolerance
  // to |Pd|), but never this fraction of the solution.
  constexpr double check_factor  = 1000;
  constexpr double largest_limit = 0.05;

  /// The tolerance of a solution: that of the options, or with Tolerance = auto the residual at which it was accepted.
  double tolerance_of(const scene::SolverOptions &options, const contact::DualSolution &solution);

  /// Checks above this limit count as failed.
  double check_limit(const double tolerance);

  /// Whether the solver converged and all checks are within the limit.
  bool passes(const contact::DualSolution &solution, const contact::Checks &checks, const double tolerance);

  /// Case, version, number of ranks.
  template <int dim>
  output::Summary empty_summary(const scene::Scene<dim> &scene, const MPI_Comm comm);

  /// Combines the step in @p summary with the previous steps: counts are summed, the worst residuals kept.
  void add_step(const output::Summary &so_far, const double load_factor, output::Summary &summary);

  /// Forces distributed over a circumference have no moment: all moments of bodies of revolution are set to 0.
  template <int dim>
  void drop_moments(const scene::Scene<dim> &scene, output::ResultSummary &results);

  /// Largest component of the force of a load or support, or force of a pair [N].
  double largest_force(const output::ResultSummary &results);

  /// All entries of summary.json except times and memory.
  template <int dim>
  output::Summary make_summary(const scene::Scene<dim>       &scene,
                               const mesh::Mesh<dim>         &mesh,
                               const mechanics::Spaces<dim>  &spaces,
                               const tfeti::DualProblem      &dual,
                               const contact::DualSolution   &solution,
                               const contact::Checks         &checks,
                               const mechanics::StressResult &stress);
} // namespace slipstick::app
