// Console output of a run.
#pragma once

#include <slipstick/app/run_summary.h>
#include <slipstick/base/log.h>

namespace slipstick::app
{
  /// Prints the header: program, libraries, ranks, case.
  template <int dim>
  void print_header(const Log &log, const scene::Scene<dim> &scene, const MPI_Comm comm);

  /// Prints the sizes of the problem, one line per stage.
  template <int dim>
  void print_mesh(const Log                    &log,
                  const scene::Scene<dim>      &scene,
                  const mesh::Mesh<dim>        &mesh,
                  const mechanics::Spaces<dim> &spaces);

  /// @return the texts of the printed warnings, without "warning: ".
  template <int dim>
  std::vector<std::string> warnings_before(const scene::Scene<dim> &scene, const mesh::Mesh<dim> &mesh);

  /// Prints the numbers of multipliers by kind.
  void print_constraints(const Log &log, const tfeti::Constraints &constraints);

  /// Prints the form of the dual operator and its norm.
  void print_dual(const Log &log, const tfeti::DualProblem &dual);

  /// Prints the checks computed from the recovered displacement.
  void print_checks(const Log &log, const contact::Checks &checks, const double tolerance);

  /// Message for a solution that fails the checks: which check, by how much and where, and a remedy.
  template <int dim>
  void print_failure(const Log                   &log,
                     const scene::Scene<dim>     &scene,
                     const contact::DualSolution &solution,
                     const contact::Checks       &checks,
                     const double                 tolerance);

  /// Prints the resultants of loads, supports, foundations and contact pairs, and the sum of the external ones.
  template <int dim>
  void print_forces(const Log &log, const scene::Scene<dim> &scene, const output::ResultSummary &results);

  /// Prints the main results and the file to open.
  void print_result(const Log &log, const output::Summary &summary, const std::string &pvd);
} // namespace slipstick::app
