// Nodes at points of bodies, for point loads and point supports.
#pragma once

#include <slipstick/mechanics/spaces.h>

namespace slipstick::mechanics
{
  /// One copy of a node.
  template <int dim>
  struct PointNode
  {
    unsigned int       subdomain = 0; // global number
    unsigned int       node      = 0; // in that subdomain
    dealii::Point<dim> position;
  };

  /// The node nearest to each of @p points, the same on all ranks: one copy of it (that of the lowest subdomain); of
  /// nodes at the same distance the one with the smallest x, then y. @p owners: name of each point in messages, e.g.
  /// "Point load pull". Named points must be in mesh.points. Collective.
  /// @throws InputError when no node of the body lies within 0.6 diameters of a cell (a point inside the mesh is never
  /// refused).
  template <int dim>
  std::vector<PointNode<dim>> nodes_at(const scene::Scene<dim>                  &scene,
                                       const mesh::Mesh<dim>                    &mesh,
                                       const Spaces<dim>                        &spaces,
                                       const std::vector<scene::PointName<dim>> &points,
                                       const std::vector<std::string>           &owners);
} // namespace slipstick::mechanics
