// Effect of supports and foundations on one node.
#pragma once

#include <slipstick/interface/interface_node.h>

namespace slipstick::interface
{
  /// Prescribes the displacement along @p direction, unless the directions held already imply it: in that case the
  /// force in the nearest of these is shared with the conditions @p by (see InterfaceNode::Held).
  /// @throws InputError when they imply another value.
  template <int dim>
  void hold(InterfaceNode<dim>              &node,
            const dealii::Tensor<1, dim>    &direction,
            const double                     value,
            const unsigned int               which,
            const std::vector<unsigned int> &by);

  /// Converts the sides of a complete node into held directions and springs.
  /// @throws InputError as hold() does.
  template <int dim>
  void resolve_sides(InterfaceNode<dim> &node, const scene::Scene<dim> &scene, const double t);
} // namespace slipstick::interface
