#include <slipstick/base/exceptions.h>
#include <slipstick/interface/solid_surface.h>

#include <algorithm>
#include <array>
#include <vector>

namespace slipstick::interface
{
  namespace
  {
    using Triangles = std::vector<std::array<unsigned int, 3>>;

    /// Triangles between the nodes of a facet, with its orientation.
    const Triangles &triangles_of(const mechanics::SurfaceFacet &facet)
    {
      static const Triangles triangle{{{0, 1, 2}}}, quadrilateral{{{0, 1, 2}}, {{0, 2, 3}}},
        quadratic_triangle{{{0, 3, 5}}, {{3, 1, 4}}, {{5, 4, 2}}, {{3, 4, 5}}},
        quadratic_quadrilateral{{{8, 0, 4}},
                                {{8, 4, 1}},
                                {{8, 1, 5}},
                                {{8, 5, 2}},
                                {{8, 2, 6}},
                                {{8, 6, 3}},
                                {{8, 3, 7}},
                                {{8, 7, 0}}};
      if (facet.n_corners() == 3)
        return facet.is_quadratic() ? quadratic_triangle : triangle;
      return facet.is_quadratic() ? quadratic_quadrilateral : quadrilateral;
    }
  } // namespace

  SolidSurface::SolidSurface(const std::vector<mechanics::SurfaceFacet> &facets)
  {
    std::vector<dealii::Point<3>> corners;
    for (const auto &facet : facets)
      for (const auto &[a, b, c] : triangles_of(facet))
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
