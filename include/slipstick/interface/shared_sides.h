// The same surface in two contact pairs.
#pragma once

#include <slipstick/mechanics/surface.h>

namespace slipstick::interface
{
  /// Two pairs must not join the same edges, whatever their names: both would carry load there, and slip bounds would
  /// add up. Of two bodies the shared edges must also face each other, whichever side is the slave. Collective.
  /// @throws InputError on all ranks, with both pairs and an edge that they share.
  template <int dim>
  void check_shared_sides(const scene::Scene<dim>      &scene,
                          const mesh::Mesh<dim>        &mesh,
                          const mechanics::Spaces<dim> &spaces);
} // namespace slipstick::interface
