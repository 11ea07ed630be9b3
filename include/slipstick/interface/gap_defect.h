// What gaps at nodes leave out of the gap between them.
#pragma once

#include <slipstick/interface/body_contact.h>

namespace slipstick::interface
{
  template <int dim>
  struct GapDefects
  {
    /// By contact pair and slave node: the mean over its tributary area of the gap interpolated from the nodes, less that of the
    /// surfaces [mm]; positive where a convex obstacle is touched.
    std::vector<std::map<mechanics::NodeKey, double>> of_pairs;

    /// On how many edges or facets of its side a slave node is.
    std::vector<std::map<mechanics::NodeKey, unsigned int>> n_parts;
  };

  /// Of obstacles, and of pairs of bodies that are coupled node to node; mortar gaps are means already. Known to every rank. Collective.
  template <int dim>
  GapDefects<dim> gap_defects(const scene::Scene<dim>      &scene,
                              const mesh::Mesh<dim>        &mesh,
                              const mechanics::Spaces<dim> &spaces,
                              const double                  t);
} // namespace slipstick::interface
