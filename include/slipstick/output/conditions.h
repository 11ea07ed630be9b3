// conditions.csv: places of supports, loads and contact pairs, for programs that draw the scene.
#pragma once

#include <slipstick/mechanics/spaces.h>
#include <slipstick/output/directory.h>

namespace slipstick::output
{
  /// Writes conditions.csv from rank 0: one row for every edge (in space face), before loading, of a boundary used by a
  /// support, foundation, traction or contact pair, and for every point used by a support or point load (all end points
  /// are then the node); followed by the rows of LoadPlace. Collective.
  template <int dim>
  void write_conditions(const OutputDirectory        &directory,
                        const scene::Scene<dim>      &scene,
                        const mesh::Mesh<dim>        &mesh,
                        const mechanics::Spaces<dim> &spaces);
} // namespace slipstick::output
