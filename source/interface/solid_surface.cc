#include <slipstick/base/exceptions.h>
#include <slipstick/interface/solid_surface.h>

#include <algorithm>

namespace slipstick::interface
{
  SolidSurface::SolidSurface(const std::vector<mechanics::SurfaceFacet> &facets)
  {
    std::vector<dealii::Point<3>> corners;
    for (const auto &facet : facets)
      for (unsigned int k = 1; k + 1 < facet.n_nodes; ++k)
        corners.insert(corners.end(), {facet.node(0), facet.node(k), facet.node(k + 1)});
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
