// Stress recovery and the estimate of the discretisation error.
#pragma once

#include <slipstick/fem/spaces.h>
#include <slipstick/tfeti/constraints.h>

#include <Eigen/Dense>

namespace slipstick::fem
{
  /// Recovered stress on one subdomain.
  struct SubdomainStress
  {
    Eigen::MatrixXd nodal; // nodes x 3: xx, yy, xy [MPa]
    Eigen::VectorXd error; // by active cell: energy norm of recovered minus computed stress [sqrt(N mm)]
  };

  struct StressResult
  {
    std::vector<SubdomainStress> subdomains;         // of this rank
    double                       max_von_mises  = 0; // over all nodes and ranks [MPa]
    double                       energy_squared = 0; // integral of sigma : eps = twice the strain energy [N mm]
    double                       error_squared  = 0; // sum of the squares of the cells' errors [N mm]
  };

  /// Stress of the displacements @p u (by subdomain of this rank) at the nodes: cell stresses, represented one degree
  /// lower than the displacement (superconvergent points), averaged over the cells around a node with their area, across
  /// subdomains of a body too. The error indicator is that of Zienkiewicz, Zhu 1987. Collective.
  template <int dim>
  StressResult recover_stress(const scene::Scene<dim>            &scene,
                              const Mesh<dim>                    &mesh,
                              const Spaces<dim>                  &spaces,
                              const tfeti::Constraints           &constraints,
                              const std::vector<Eigen::VectorXd> &u);

  /// Out-of-plane normal stress over (xx + yy): nu in plane strain, 0 in plane stress.
  double out_of_plane_factor(const scene::Material &material, const scene::PlaneState state);

  /// Von Mises stress of xx, yy, xy and zz [MPa].
  double von_mises(const double xx, const double yy, const double xy, const double zz);
} // namespace slipstick::fem
