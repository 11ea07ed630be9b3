// Detection of surfaces that belong to two contact pairs.
#pragma once

#include <slipstick/mechanics/surface.h>

namespace slipstick::interface
{
  /// Checks that no two pairs join the same edges, whatever their names: both would carry load there, and the slip
  /// bounds would add up. For pairs of bodies the shared edges must also face each other, whichever side is the slave.
  /// Collective.
  /// @throws InputError on all ranks, naming both pairs and an edge that they share.
  template <int dim>
  void check_shared_sides(const scene::Scene<dim>      &scene,
                          const mesh::Mesh<dim>        &mesh,
                          const mechanics::Spaces<dim> &spaces);
} // namespace slipstick::interface
