// How deep points are inside a solid.
#pragma once

#include <slipstick/mechanics/surface_facet.h>
#include <slipstick/scene/triangulated_surface.h>

#include <optional>

namespace slipstick::interface
{
  /// The whole surface of a body, holes included; of triangles between its nodes.
  class SolidSurface
  {
  public:
    explicit SolidSurface(const std::vector<mechanics::SurfaceFacet> &facets);

    /// Distance from the surface [mm], 0 outside. Always 0 where surfaces of a body touch each other (flanks of a slit): what
    /// is inside cannot be told from the triangles there.
    double depth(const dealii::Point<3> &x) const;

  private:
    std::optional<scene::TriangulatedSurface> surface; // none if it is not closed
  };
} // namespace slipstick::interface
