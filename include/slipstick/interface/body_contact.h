// Contact and bonds between bodies: which nodes face which.
#pragma once

#include <slipstick/interface/mortar.h>

namespace slipstick::interface
{
  /// All pairs of bodies, known to every rank.
  template <int dim>
  struct BodyContacts
  {
    std::vector<std::vector<MortarRow<dim>>> rows; // by contact pair; none for obstacles

    /// Subdomain whose rank owns the rows of a node: one for all nodes that are connected through rows, so that rows
    /// which share a node are on one rank. Nodes not listed here may be owned by any rank.
    std::map<mechanics::NodeKey, unsigned int> owner;
  };

  /// Pairs the boundaries according to ContactPair. A pair without a reach of its own gets the smallest distance of its
  /// sides where they face each other plus twice the mesh size (mean edge of the coarser side) or a tenth of the
  /// smaller side, whichever is larger. Computed alike by every rank. Collective.
  /// @throws InputError on all ranks for a pair without any facing parts within its reach, and as check_sides does.
  template <int dim>
  BodyContacts<dim> pair_bodies(const scene::Scene<dim>      &scene,
                                const mesh::Mesh<dim>        &mesh,
                                const mechanics::Spaces<dim> &spaces);
} // namespace slipstick::interface
