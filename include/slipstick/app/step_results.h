// Results of a solved load step: forces, places, probes and contact nodes.
#pragma once

#include <slipstick/app/restart.h>
#include <slipstick/app/step_solver.h>
#include <slipstick/mechanics/probes.h>
#include <slipstick/output/contact_line.h>
#include <slipstick/output/summary.h>

#include <map>
#include <string>

namespace slipstick::app
{
  /// Texts by subject; each subject is reported once per run.
  using Warnings = std::map<std::string, std::string>;

  /// Resultants of loads, supports and foundations at load factor @p t. Collective.
  /// @param warnings receives loads whose formulas are not resolved by any mesh, and forces on motions that are held
  /// because nothing resists them.
  template <int dim>
  output::ForceSummary forces(const StepSolver<dim> &solver,
                              const StepSolution    &answer,
                              const double           t,
                              Warnings              &warnings);

  /// Sets in @p summary the places of the largest stress and error, and whether the stress there is singular.
  /// Collective.
  template <int dim>
  void add_places(const StepSolver<dim> &solver, const mechanics::StressResult &stress, output::Summary &summary);

  /// Collective.
  template <int dim>
  std::vector<output::ProbeResult> probe_results(const scene::Scene<dim>            &scene,
                                                 const mechanics::Probes<dim>       &probes,
                                                 const std::vector<Eigen::VectorXd> &u,
                                                 const mechanics::StressResult      &stress);

  /// Contact nodes of all ranks on rank 0, with their arc lengths; in space with the faces between them. Collective.
  /// @param total_slip the slip of this step is added to it, on rank 0. @param keys_of_nodes returns the keys of the
  /// contact nodes, in their order, on rank 0.
  template <int dim>
  output::ContactStep gather_contact(const StepSolver<dim>           &solver,
                                     const contact::CheckedContact   &own,
                                     TotalSlip                       &total_slip,
                                     std::vector<mechanics::NodeKey> &keys_of_nodes);
} // namespace slipstick::app
