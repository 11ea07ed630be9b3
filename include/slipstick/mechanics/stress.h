// Stress recovery and estimation of the discretisation error.
#pragma once

#include <slipstick/mechanics/spaces.h>
#include <slipstick/tfeti/constraints.h>

#include <Eigen/Dense>

namespace slipstick::mechanics
{
  /// Recovered stress on one subdomain.
  struct SubdomainStress
  {
    Eigen::MatrixXd nodal; // nodes x 4: xx, yy, xy, zz (for bodies of revolution the hoop stress); in space x 6:
                           // also xz, yz [MPa]
    Eigen::VectorXd error; // by active cell: energy norm of recovered minus computed stress [sqrt(N mm)]
  };

  struct StressResult
  {
    std::vector<SubdomainStress> subdomains;              // of this rank
    bool                         has_hoop_stress = false; // zz is the hoop stress
    double min_hoop_stress = 0, max_hoop_stress = 0;      // over all nodes and ranks, if there is a hoop stress [MPa]
    double max_von_mises  = 0;                            // over all nodes and ranks [MPa]
    double energy_squared = 0; // integral of sigma : C^-1 : sigma, twice the elastic energy [N mm]
    double error_squared  = 0; // sum of the squares of the cells' errors [N mm]
  };

  /// Nodal stress (recover_nodal) for the displacements @p u, by subdomain of this rank, at load factor @p t. Thermal
  /// strain is subtracted; where the element projects the dilatation, its stress uses the projected one. The error
  /// indicator is that of Zienkiewicz, Zhu 1987. Collective.
  template <int dim>
  StressResult recover_stress(const scene::Scene<dim>            &scene,
                              const mesh::Mesh<dim>              &mesh,
                              const Spaces<dim>                  &spaces,
                              const tfeti::Constraints           &constraints,
                              const std::vector<Eigen::VectorXd> &u,
                              const double                        t);
} // namespace slipstick::mechanics
