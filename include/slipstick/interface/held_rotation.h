// Bodies whose supports hold their rotation.
#pragma once

#include <slipstick/mechanics/surface_facet.h>

namespace slipstick::interface
{
  /// Whether the displacements prescribed by supports determine the rotation of the body as a whole, in space about all
  /// axes. Not counted: contact, bonds, foundations, supports of points with a physical name.
  /// @param all outlines, among them that of the body.
  template <int dim>
  bool supports_hold_rotation(const scene::Scene<dim>                         &scene,
                              const mesh::Mesh<dim>                           &mesh,
                              const std::vector<mechanics::BoundaryPart<dim>> &all,
                              const unsigned int                               body);
} // namespace slipstick::interface
