// How far the nodes of contact.csv moved, so that contact lines can be drawn where they are.
#pragma once

#include <slipstick/mechanics/stress.h>

#include <array>
#include <vector>

namespace slipstick::output
{
  /// On rank 0 that of every node [mm]. @param nodes those of rank 0 count. @param u of the subdomains of this rank. Collective.
  template <int dim>
  std::vector<std::array<double, 3>> contact_displacement(const mesh::Mesh<dim>                 &mesh,
                                                          const mechanics::Spaces<dim>          &spaces,
                                                          const std::vector<Eigen::VectorXd>    &u,
                                                          const std::vector<mechanics::NodeKey> &nodes);
} // namespace slipstick::output
