// Where bonded contacts end.
#pragma once

#include <slipstick/mechanics/creases.h>
#include <slipstick/mechanics/outline_vertices.h>

namespace slipstick::mechanics
{
  template <int dim>
  struct BondEnd
  {
    unsigned int       body = 0, pair = 0; // index in Scene::contacts
    dealii::Point<dim> position;
  };

  /// Ends of bonded pairs at which the stress of linear elasticity is infinite: the angles of the two bodies add up to
  /// more than 180 degrees, so that they form a re-entrant corner (or a crack), or, at an obstacle, the angle of the
  /// body is at least that of the end of a clamp with infinite stress. One entry for each body. Ends beside supported
  /// edges are left out (planes of symmetry).
  /// @param vertices of the outlines of all bodies. @param n_supports only the first n_supports of scene.supports are
  /// considered.
  template <int dim>
  std::vector<BondEnd<dim>> bond_ends(const scene::Scene<dim>               &scene,
                                      const mesh::Mesh<dim>                 &mesh,
                                      const std::vector<OutlineVertex<dim>> &vertices,
                                      const unsigned int                     n_supports);

  struct BondEdge
  {
    unsigned int  body = 0, pair = 0; // index in Scene::contacts
    const Crease *crease = nullptr;   // of this body or the other
  };

  /// The same in space, for the angles in the planes perpendicular to the edges. @param creases of all bodies, which
  /// the result refers to. Collective.
  std::vector<BondEdge> bond_edges(const scene::Scene<3>     &scene,
                                   const mesh::Mesh<3>       &mesh,
                                   const Spaces<3>           &spaces,
                                   const std::vector<Crease> &creases,
                                   const unsigned int         n_supports);
} // namespace slipstick::mechanics
