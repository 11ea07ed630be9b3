// Of a load step that is solved: forces, places, probes and contact nodes, as the results show them.
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
  /// Texts by what they are about, which is warned of once in a run.
  using Warnings = std::map<std::string, std::string>;

  /// Resultants of loads, supports and foundations at load factor @p t. Collective.
  /// @param warnings gets loads whose formulas no mesh resolves, and forces on motions that are held because nothing
  /// resists them.
  template <int dim>
  output::ForceSummary forces(const StepSolver<dim> &solver,
                              const StepAnswer      &answer,
                              const double           t,
                              Warnings              &warnings);

  /// Puts into @p summary where stress and error are largest, and whether more than the mesh is in the way there. Collective.
  template <int dim>
  void add_places(const StepSolver<dim> &solver, const mechanics::StressResult &stress, output::Summary &summary);

  /// Collective.
  template <int dim>
  std::vector<output::ProbeResult> probe_results(const scene::Scene<dim>            &scene,
                                                 const mechanics::Probes<dim>       &probes,
                                                 const std::vector<Eigen::VectorXd> &u,
                                                 const mechanics::StressResult      &stress);

  /// Contact nodes of all ranks on rank 0, with their arc lengths; in space with the faces between them. Collective.
  /// @param total_slip gets the slip of this step added, on rank 0. @param keys_of_nodes gets those of the contact nodes, in
  /// their order, on rank 0.
  template <int dim>
  output::ContactStep gather_contact(const StepSolver<dim>           &solver,
                                     const contact::CheckedContact   &own,
                                     TotalSlip                       &total_slip,
                                     std::vector<mechanics::NodeKey> &keys_of_nodes);

  template <int dim>
  output::ContactNames contact_names(const scene::Scene<dim> &scene);
} // namespace slipstick::app
