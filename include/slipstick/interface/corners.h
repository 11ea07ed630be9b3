// Corners of bodies at the ends of contact sides.
#pragma once

#include <slipstick/interface/surface_nodes.h>
#include <slipstick/mesh/mesh.h>

#include <set>

namespace slipstick::interface
{
  /// Nodes at corners, in space also at edges, of bodies.
  using Corners = std::set<mechanics::NodeKey>;

  /// The nodes of a contact side at which the outline of the body turns away from that side. There the side has no
  /// normal of its own: a contact force is normal to the other side. At planes of symmetry, which supports hold along
  /// their normal, and on the axis of revolution the body continues: nodes there are no corners because of them.
  /// @param side the parts on @p where. @param outline all parts of the body.
  template <int dim>
  Corners corners_of(const scene::Scene<dim>                         &scene,
                     const mesh::Mesh<dim>                           &mesh,
                     const scene::BoundaryName                       &where,
                     const std::vector<mechanics::BoundaryPart<dim>> &side,
                     const std::vector<mechanics::BoundaryPart<dim>> &outline);

  /// The normal of the contact at a slave node: the mean of both sides, at a corner of one side that of the other.
  /// @param facing outward normal of the master there, zero if there is none.
  template <int dim>
  dealii::Tensor<1, dim> mean_normal(const SurfaceNode<dim>       &node,
                                     const dealii::Tensor<1, dim> &facing,
                                     const bool                    is_at_corner_of_master,
                                     const Corners                &corners)
  {
    const bool is_corner = facing.norm() > 0 && corners.count(node.key) > 0;
    if (is_corner != is_at_corner_of_master)
      return is_corner ? -1. * facing : node.normal;
    const dealii::Tensor<1, dim> sum = node.normal - facing;
    return sum / sum.norm();
  }

  /// Whether the place on a part with the values @p N of the shape functions is at one of these nodes.
  template <class Part, class Shape>
  bool is_at_corner(const Part &part, const Shape &N, const Corners &corners)
  {
    constexpr double at_node = 1 - 1e-9;
    for (unsigned int i = 0; i < part.n_nodes; ++i)
      if (N[i] >= at_node)
        return corners.count(part.keys[i]) > 0;
    return false;
  }
} // namespace slipstick::interface
