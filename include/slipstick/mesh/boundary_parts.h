// Boundaries by condition on the edges of a mesh.
#pragma once

#include <slipstick/mesh/body_mesh.h>

namespace slipstick::mesh
{
  /// Assigns edges to the boundaries of body @p b that the scene names with a condition: those whose midpoint, as
  /// placed and before loading, meets it. A remark reports edges on which the condition changes.
  /// @throws InputError for a condition that no edge fulfils.
  template <int dim>
  void add_boundary_parts(const scene::Scene<dim> &scene, const unsigned int b, BodyMesh<dim> &mesh);
} // namespace slipstick::mesh
