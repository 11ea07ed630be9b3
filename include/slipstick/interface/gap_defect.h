// Difference between the nodal gaps and the gap between the nodes.
#pragma once

#include <slipstick/interface/body_contact.h>

namespace slipstick::interface
{
  template <int dim>
  struct GapDefects
  {
    /// By contact pair and slave node: the mean over its tributary area of the gap interpolated from the nodes, minus
    /// that of the surfaces [mm]; positive for contact with a convex obstacle.
    std::vector<std::map<mechanics::NodeKey, double>> of_pairs;

    /// Number of edges or facets of its side that contain a slave node.
    std::vector<std::map<mechanics::NodeKey, unsigned int>> n_parts;
  };

  /// For obstacles and for pairs of bodies coupled node to node; mortar gaps are means already. The same on every rank.
  /// Collective.
  template <int dim>
  GapDefects<dim> gap_defects(const scene::Scene<dim>      &scene,
                              const mesh::Mesh<dim>        &mesh,
                              const mechanics::Spaces<dim> &spaces,
                              const double                  t);
} // namespace slipstick::interface
