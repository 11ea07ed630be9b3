// Boundaries by condition on the edges of a mesh.
#pragma once

#include <slipstick/mesh/body_mesh.h>

namespace slipstick::mesh
{
  /// Gives the boundaries of body @p b that the scene names with a condition their edges: those whose middle, as placed and
  /// before loading, fulfils it. Where an edge does so in part, a remark tells of it.
  /// @throws InputError for a condition that no edge fulfils.
  template <int dim>
  void add_boundary_parts(const scene::Scene<dim> &scene, const unsigned int b, BodyMesh<dim> &mesh);
} // namespace slipstick::mesh
