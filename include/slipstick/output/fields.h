// Fields for ParaView: one .vtu per subdomain, the .pvtu that combines them, the .pvd over the load steps.
#pragma once

#include <slipstick/mechanics/stress.h>
#include <slipstick/output/directory.h>

namespace slipstick::output
{
  /// Writes subdomain_NNN_PPPP.vtu (NNN: step, PPPP: subdomain) on the ranks of the subdomains and solution_NNN.pvtu on
  /// rank 0. Nodal fields: displacement [mm], stress tensor, its out-of-plane component, principal (in the plane) and
  /// von Mises stress [MPa]. Cell fields: body, subdomain, rank and error estimate [sqrt(N mm)]. Compressed binary.
  /// Collective.
  template <int dim>
  void write_fields(const OutputDirectory              &directory,
                    const mesh::Mesh<dim>              &mesh,
                    const mechanics::Spaces<dim>       &spaces,
                    const std::vector<Eigen::VectorXd> &u,
                    const mechanics::StressResult      &stress,
                    const unsigned int                  step);

  /// Writes solution.pvd over the steps, with the load factor of each as its time. Collective.
  void write_pvd(const OutputDirectory &directory, const std::vector<double> &load_factors);
} // namespace slipstick::output
