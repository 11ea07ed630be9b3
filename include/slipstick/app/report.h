// What a run says on the console.
#pragma once

#include <slipstick/app/run_summary.h>
#include <slipstick/base/log.h>

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

  /// The checks from the recovered displacement.
  void print_checks(const Log &log, const contact::Checks &checks, const double tolerance);

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
} // namespace slipstick::app
