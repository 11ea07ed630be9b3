// Penetration of the slave boundary into an obstacle between its nodes, and of an obstacle into a body.
#pragma once

#include <slipstick/interface/deepest_penetration.h>
#include <slipstick/interface/edge_tree.h>
#include <slipstick/mesh/mesh.h>
#include <slipstick/scene/scene.h>

#include <vector>

namespace slipstick::interface
{
  /// Finds the deepest place of the slave boundary in the obstacle of the pair, if it is deeper than @p deepest.
  /// @param slave boundary before loading. @param now the same after loading. @param t load factor.
  template <int dim>
  void find_in_obstacle(const scene::Scene<dim>                         &scene,
                        const scene::ContactPair<dim>                   &pair,
                        const std::vector<mechanics::BoundaryPart<dim>> &slave,
                        const std::vector<mechanics::BoundaryPart<dim>> &now,
                        const double                                     t,
                        std::optional<Penetration>                      &deepest);

  /// The same for obstacles that lie entirely inside the body. @param body after loading.
  void find_points_of_obstacle(const scene::Scene<2>       &scene,
                               const mesh::Mesh<2>         &mesh,
                               const scene::ContactPair<2> &pair,
                               const ClosedOutline         &body,
                               const double                 t,
                               std::optional<Penetration>  &deepest);

  /// The same in space. @param all facets of the body after loading. @param slave facets of the pair.
  void find_points_of_obstacle(const scene::Scene<3>                      &scene,
                               const scene::ContactPair<3>                &pair,
                               const std::vector<mechanics::SurfaceFacet> &all,
                               const std::vector<mechanics::SurfaceFacet> &slave,
                               const double                                t,
                               std::optional<Penetration>                 &deepest);
} // namespace slipstick::interface
