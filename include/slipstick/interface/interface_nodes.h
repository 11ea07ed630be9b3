// All nodes shared by several subdomains, or subject to supports, foundations or contact.
#pragma once

#include <slipstick/interface/body_contact.h>
#include <slipstick/interface/interface_node.h>

namespace slipstick::interface
{
  /// The interface nodes owned by this rank, with all their copies, sorted by key: nodes of @p contacts on the rank
  /// given there, others on the rank of their first copy. Nodes with a single copy and no conditions are omitted.
  ///
  /// Supports along the normal hold a node along the average of the outward normals of its edges, or along each of them
  /// at a corner; a component or normal that is implied by the others is omitted. Bonds to an obstacle hold all
  /// components. Foundations become springs along the principal directions of their combined stiffness.
  /// Collective.
  /// @throws InputError on all ranks when supports contradict each other at a node, or a point support has no node.
  template <int dim>
  std::vector<InterfaceNode<dim>> interface_nodes(const scene::Scene<dim>      &scene,
                                                  const mesh::Mesh<dim>        &mesh,
                                                  const mechanics::Spaces<dim> &spaces,
                                                  const BodyContacts<dim>      &contacts,
                                                  const double                  t);
} // namespace slipstick::interface
