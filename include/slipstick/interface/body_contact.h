// Contact and bonds between bodies: pairing of nodes.
#pragma once

#include <slipstick/interface/mortar.h>

#include <optional>

namespace slipstick::interface
{
  /// All pairs of bodies, stored on every rank.
  template <int dim>
  struct BodyContacts
  {
    std::vector<std::vector<MortarRow<dim>>> rows; // by contact pair; empty for obstacles

    /// Subdomain whose rank owns the rows of a node: the same for all nodes that are connected through rows, so that
    /// rows which share a node are on one rank. Nodes not listed here may be owned by any rank.
    std::map<mechanics::NodeKey, unsigned int> owner;
  };

  /// Pairs the boundaries according to ContactPair. The automatic reach of a pair is the smallest distance of its sides
  /// where they face each other plus the larger of twice the mesh size (mean edge of the coarser side) and a tenth of
  /// the smaller side. The result is the same on every rank. Collective.
  /// @throws InputError on all ranks for a pair without facing parts within its reach, and as check_sides does.
  template <int dim>
  BodyContacts<dim> pair_bodies(const scene::Scene<dim>      &scene,
                                const mesh::Mesh<dim>        &mesh,
                                const mechanics::Spaces<dim> &spaces);

  /// The same with rows that follow the rotations of both sides across gaps that close between two bodies, too
  /// (gap_rotation.h); none if these are the same. Collective.
  template <int dim>
  std::optional<BodyContacts<dim>> with_rotating_gaps(const scene::Scene<dim>      &scene,
                                                      const mesh::Mesh<dim>        &mesh,
                                                      const mechanics::Spaces<dim> &spaces,
                                                      const BodyContacts<dim>      &contacts);
} // namespace slipstick::interface
