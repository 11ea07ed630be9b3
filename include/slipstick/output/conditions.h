// conditions.csv: where supports, loads and contact pairs act, for programs that draw the scene.
#pragma once

#include <slipstick/mechanics/spaces.h>
#include <slipstick/output/directory.h>

namespace slipstick::output
{
  /// Writes conditions.csv from rank 0: one row for every edge (in space face), before loading, of a boundary that a support,
  /// foundation, traction or contact pair names, and for every point that a support or point load names (all ends are
  /// then the node); then the rows of LoadPlace. Collective.
  template <int dim>
  void write_conditions(const OutputDirectory        &directory,
                        const scene::Scene<dim>      &scene,
                        const mesh::Mesh<dim>        &mesh,
                        const mechanics::Spaces<dim> &spaces);
} // namespace slipstick::output
