// What supports and foundations do to one node.
#pragma once

#include <slipstick/interface/interface_node.h>

namespace slipstick::interface
{
  /// Prescribes the displacement along @p direction, unless the directions held already imply it: then the force in the
  /// nearest of these is shared with those that it is held @p by (as InterfaceNode::Held says).
  /// @throws InputError when they imply another value.
  template <int dim>
  void hold(InterfaceNode<dim>              &node,
            const dealii::Tensor<1, dim>    &direction,
            const double                     value,
            const unsigned int               which,
            const std::vector<unsigned int> &by);

  /// Turns the sides of a node that is complete into held directions and springs.
  /// @throws InputError as hold() does.
  template <int dim>
  void resolve_sides(InterfaceNode<dim> &node, const scene::Scene<dim> &scene, const double t);
} // namespace slipstick::interface
