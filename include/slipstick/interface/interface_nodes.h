// All nodes that several subdomains share, or that supports, foundations or contact act on.
#pragma once

#include <slipstick/interface/body_contact.h>
#include <slipstick/interface/interface_node.h>

namespace slipstick::interface
{
  /// The interface nodes that this rank owns, complete, sorted by key: nodes of @p contacts on the rank given there,
  /// others on that of their first copy. Nodes with a single copy on which nothing acts are left out.
  ///
  /// Supports along the normal hold a node along the average of the outward normals of the edges there, or along each
  /// of them where they form a corner; a component or normal that the others imply is left out. Bonds to an obstacle
  /// hold all components. Foundations become springs along the principal directions of their joint stiffness.
  /// Collective.
  /// @throws InputError on all ranks when supports contradict each other at a node, or a point support has no node.
  template <int dim>
  std::vector<InterfaceNode<dim>> interface_nodes(const scene::Scene<dim>      &scene,
                                                  const mesh::Mesh<dim>        &mesh,
                                                  const mechanics::Spaces<dim> &spaces,
                                                  const BodyContacts<dim>      &contacts,
                                                  const double                  t);
} // namespace slipstick::interface
