// Body forces that balance bodies as inertia does.
#pragma once

#include <slipstick/mechanics/spaces.h>
#include <slipstick/scene/scene.h>

#include <Eigen/Core>

#include <vector>

namespace slipstick::mechanics
{
  /// Nodal forces of body forces equal to the rigid motions of each body about its frame (1 N/mm^3 per unit motion), for
  /// every subdomain of this rank: unknowns x motions. Their sum does not depend on the partition. Collective.
  template <int dim>
  std::vector<Eigen::MatrixXd> rigid_body_forces(const scene::Scene<dim> &scene,
                                                 const mesh::Mesh<dim>   &mesh,
                                                 const Spaces<dim>       &spaces);
} // namespace slipstick::mechanics
