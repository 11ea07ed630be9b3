// Point supports that suppress rigid motions which nothing else holds.
#pragma once

#include <slipstick/mechanics/spaces.h>
#include <slipstick/tfeti/subdomain_matrices.h>

namespace slipstick::mechanics
{
  /// Point supports that hold rigid motions: for each motion one displacement component of one node, chosen in turn
  /// where the remaining motions are largest, away from outlines if the body has interior nodes. No load may act along
  /// the motions; the reactions of the supports are then zero, and their choice changes the solution only by a rigid
  /// motion. The same on all ranks. Collective.
  /// @param motions orthonormal: amplitudes of translation x, y and rotation of every body about its frame.
  template <int dim>
  std::vector<scene::PrescribedDisplacement<dim>> auxiliary_supports(const mesh::Mesh<dim>               &mesh,
                                                                     const Spaces<dim>                   &spaces,
                                                                     const std::vector<Eigen::VectorXd>  &motions,
                                                                     const std::vector<tfeti::BodyFrame> &frames);
} // namespace slipstick::mechanics
