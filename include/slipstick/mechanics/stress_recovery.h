// Recovery of nodal stresses from stresses at superconvergent points of the cells.
#pragma once

#include <slipstick/mechanics/spaces.h>
#include <slipstick/tfeti/constraints.h>

#include <Eigen/Dense>

#include <vector>

namespace slipstick::mechanics
{
  /// Nodal stresses of the displacements @p u, by subdomain of this rank, nodes x components of StressModel [MPa]:
  /// values of polynomials that fit the stresses at the points of Element::stress around every vertex (LinearPatches,
  /// QuadraticPatches), also across the subdomains of a body. Collective.
  template <int dim>
  std::vector<Eigen::MatrixXd> recover_nodal(const scene::Scene<dim>            &scene,
                                             const mesh::Mesh<dim>              &mesh,
                                             const Spaces<dim>                  &spaces,
                                             const tfeti::Constraints           &constraints,
                                             const std::vector<Eigen::VectorXd> &u,
                                             const double                        t);
} // namespace slipstick::mechanics
