// How far the nodes of contact.csv moved, so that contact lines can be drawn where they are.
#pragma once

#include <slipstick/contact/result.h>
#include <slipstick/mechanics/stress.h>

#include <array>
#include <vector>

namespace slipstick::output
{
  /// On rank 0 that of every node [mm], not a number where the slave body has no node. @param nodes of rank 0 count. @param u of
  /// the subdomains of this rank. Collective.
  template <int dim>
  std::vector<std::array<double, 3>> contact_displacement(const scene::Scene<dim>                 &scene,
                                                          const mesh::Mesh<dim>                   &mesh,
                                                          const mechanics::Spaces<dim>            &spaces,
                                                          const std::vector<Eigen::VectorXd>      &u,
                                                          const std::vector<contact::ContactNode> &nodes);
} // namespace slipstick::output
