// Displacements of the nodes of contact.csv, for drawing contact lines in the deformed configuration.
#pragma once

#include <slipstick/mechanics/stress.h>

#include <array>
#include <vector>

namespace slipstick::output
{
  /// Displacement of every node [mm], on rank 0. @param nodes only those on rank 0 are used. @param u displacement of
  /// the subdomains of this rank. Collective.
  template <int dim>
  std::vector<std::array<double, 3>> contact_displacement(const mesh::Mesh<dim>                 &mesh,
                                                          const mechanics::Spaces<dim>          &spaces,
                                                          const std::vector<Eigen::VectorXd>    &u,
                                                          const std::vector<mechanics::NodeKey> &nodes);
} // namespace slipstick::output
