// Where bonded contacts of plane bodies end.
#pragma once

#include <slipstick/mechanics/singular_points.h>
#include <slipstick/mechanics/surface.h>

namespace slipstick::mechanics
{
  /// Ends of bonded pairs at which the stress of linear elasticity is infinite: the angles of the two bodies add up to more
  /// than half a turn, so that they form a re-entrant corner (or a crack), or the angle at an obstacle is that of the end
  /// of a clamp. A point for each body. Ends beside supported edges are left out (planes of symmetry).
  /// @param edges of the outlines of all bodies. @param n_supports only the first n_supports of scene.supports count.
  template <int dim>
  std::vector<SingularPoint<dim>> bond_ends(const scene::Scene<dim>             &scene,
                                            const mesh::Mesh<dim>               &mesh,
                                            const std::vector<SurfaceEdge<dim>> &edges,
                                            const unsigned int                   n_supports);
} // namespace slipstick::mechanics
