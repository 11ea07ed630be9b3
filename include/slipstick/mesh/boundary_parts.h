// Boundaries defined by a condition on the edges of a mesh.
#pragma once

#include <slipstick/mesh/body_mesh.h>

namespace slipstick::mesh
{
  /// Assigns edges to the boundaries of body @p b that the scene defines by a condition: edges whose midpoint, as
  /// placed and before loading, satisfies it. A remark reports edges on which the condition changes.
  /// @throws InputError for a condition that no edge satisfies.
  template <int dim>
  void add_boundary_parts(const scene::Scene<dim> &scene, const unsigned int b, BodyMesh<dim> &mesh);
} // namespace slipstick::mesh
