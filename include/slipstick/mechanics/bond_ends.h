// Where bonded contacts of plane bodies end.
#pragma once

#include <slipstick/mechanics/outline_vertices.h>

namespace slipstick::mechanics
{
  template <int dim>
  struct BondEnd
  {
    unsigned int       body = 0, pair = 0; // index in Scene::contacts
    dealii::Point<dim> position;
  };

  /// Ends of bonded pairs at which the stress of linear elasticity is infinite: the angles of the two bodies add up to more
  /// than half a turn, so that they form a re-entrant corner (or a crack), or the angle at an obstacle is that of the end
  /// of a clamp. One for each body. Ends beside supported edges are left out (planes of symmetry).
  /// @param vertices of the outlines of all bodies. @param n_supports only the first n_supports of scene.supports count.
  template <int dim>
  std::vector<BondEnd<dim>> bond_ends(const scene::Scene<dim>               &scene,
                                      const mesh::Mesh<dim>                 &mesh,
                                      const std::vector<OutlineVertex<dim>> &vertices,
                                      const unsigned int                     n_supports);
} // namespace slipstick::mechanics
