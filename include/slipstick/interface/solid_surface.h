// Depth of points inside a solid.
#pragma once

#include <slipstick/mechanics/surface_facet.h>
#include <slipstick/scene/triangulated_surface.h>

#include <optional>

namespace slipstick::interface
{
  /// The whole surface of a body, including holes, as triangles between its nodes.
  class SolidSurface
  {
  public:
    explicit SolidSurface(const std::vector<mechanics::SurfaceFacet> &facets);

    /// Distance from the surface [mm], 0 outside. Always 0 if surfaces of the body touch each other (flanks of a slit):
    /// the triangles then do not determine which points are inside.
    double depth(const dealii::Point<3> &x) const;

  private:
    std::optional<scene::TriangulatedSurface> surface; // empty if it is not closed
  };
} // namespace slipstick::interface
