#include <slipstick/base/exceptions.h>
#include <slipstick/interface/part_pieces.h>
#include <slipstick/interface/solid_surface.h>

#include <algorithm>
#include <vector>

namespace slipstick::interface
{
  SolidSurface::SolidSurface(const std::vector<mechanics::SurfaceFacet> &facets)
  {
    std::vector<dealii::Point<3>> corners;
    for (const auto &facet : facets)
      for (const auto &[a, b, c] : flat_pieces(facet))
        corners.insert(corners.end(), {facet.node(a), facet.node(b), facet.node(c)});
    try
      {
        surface.emplace("body", corners);
      }
    catch (const InputError &) // coincident faces
      {}
  }

  double SolidSurface::depth(const dealii::Point<3> &x) const
  {
    return surface ? std::max(0., -surface->nearest(x).distance) : 0.;
  }
} // namespace slipstick::interface
