// Arc length along the slave boundaries, for plots along the contact.
#pragma once

#include <slipstick/mechanics/spaces.h>

namespace slipstick::interface
{
  /// Arc length [mm] of every node of a slave boundary, by contact pair and node key; on rank 0, empty elsewhere. If a
  /// boundary consists of several lines, they are measured one after the other; each starts at its end with the smaller
  /// x (then y). Collective.
  template <int dim>
  std::map<std::pair<unsigned int, mechanics::NodeKey>, double> arc_lengths(const scene::Scene<dim>      &scene,
                                                                            const mesh::Mesh<dim>        &mesh,
                                                                            const mechanics::Spaces<dim> &spaces);
} // namespace slipstick::interface
