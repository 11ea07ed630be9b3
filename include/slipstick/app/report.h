// What a run says on the console and in summary.json.
#pragma once

#include <slipstick/base/log.h>
#include <slipstick/contact/checks.h>
#include <slipstick/contact/friction.h>
#include <slipstick/mechanics/stress.h>
#include <slipstick/output/summary.h>

namespace slipstick::app
{
  /// Greeting: program, libraries, ranks, case.
  template <int dim>
  void print_header(const Log &log, const scene::Scene<dim> &scene, const MPI_Comm comm);

  /// Sizes of the problem, one line a stage.
  template <int dim>
  void print_mesh(const Log                    &log,
                  const scene::Scene<dim>      &scene,
                  const mesh::Mesh<dim>        &mesh,
                  const mechanics::Spaces<dim> &spaces);
  /// Texts of the warnings that this printed, without "warning: ".
  template <int dim>
  std::vector<std::string> warnings_before(const scene::Scene<dim> &scene, const mesh::Mesh<dim> &mesh);
  void                     print_constraints(const Log &log, const tfeti::Constraints &constraints);
  void                     print_dual(const Log &log, const tfeti::DualProblem &dual);

  /// The checks from the recovered displacement; the limit above which an answer does not count as converged.
  double check_limit(const double tolerance);
  void   print_checks(const Log &log, const contact::Checks &checks, const double tolerance);

  /// The tolerance of a solution: that of the options, or with Tolerance = auto the residual at which it was accepted.
  double tolerance_of(const scene::SolverOptions &options, const contact::DualSolution &solution);

  /// Did the solver converge, and are all checks within the limit?
  bool passes(const contact::DualSolution &solution, const contact::Checks &checks, const double tolerance);

  /// For an answer that does not pass: which test failed, by how much and where, and what to do.
  template <int dim>
  void print_failure(const Log                   &log,
                     const scene::Scene<dim>     &scene,
                     const contact::DualSolution &solution,
                     const contact::Checks       &checks,
                     const double                 tolerance);

  /// Resultants of loads, supports, foundations and contact pairs, and the sum of those from outside.
  template <int dim>
  void print_forces(const Log &log, const scene::Scene<dim> &scene, const output::ResultSummary &results);

  /// The figures that matter and the file to open.
  void print_result(const Log &log, const output::Summary &summary, const std::string &pvd);

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
