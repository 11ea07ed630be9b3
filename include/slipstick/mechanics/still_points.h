// Points that are fixed in order to suppress motions that nothing holds.
#pragma once

#include <slipstick/mechanics/spaces.h>
#include <slipstick/tfeti/subdomain_matrices.h>

namespace slipstick::mechanics
{
  /// Point supports that hold rigid motions, one displacement of one node for each: the one that moves most, in turn,
  /// away from the outlines where bodies have nodes there. No load may act along the motions; the supports then bear
  /// nothing, and the choice of points changes the answer only by a rigid motion. The same on all ranks. Collective.
  /// @param motions orthonormal: amplitudes of translation x, y and rotation of every body about its frame.
  template <int dim>
  std::vector<scene::PrescribedDisplacement<dim>> still_points(const mesh::Mesh<dim>               &mesh,
                                                               const Spaces<dim>                   &spaces,
                                                               const std::vector<Eigen::VectorXd>  &motions,
                                                               const std::vector<tfeti::BodyFrame> &frames);
} // namespace slipstick::mechanics
