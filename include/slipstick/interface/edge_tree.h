// Spatial search for boundary edges and facets.
#pragma once

#include <slipstick/base/box_tree.h>
#include <slipstick/mechanics/surface_facet.h>

#include <limits>

namespace slipstick::interface
{
  /// Tree of the bounding boxes of edges.
  class EdgeTree : public BoxTree<2>
  {
  public:
    explicit EdgeTree(const std::vector<mechanics::SurfaceEdge<2>> &edges);

    using BoxTree<2>::box_around;

    /// Smallest box around an edge (curved ones lie in that of their Bezier points).
    static Box box_around(const mechanics::SurfaceEdge<2> &edge);
  };

  /// The whole outline of a body, holes included; curved edges count as their chords.
  class ClosedOutline
  {
  public:
    /// @param edges are not copied.
    explicit ClosedOutline(const std::vector<mechanics::SurfaceEdge<2>> &edges);

    /// Is x inside? Crossings of the ray along +x are counted.
    bool contains(const dealii::Point<2> &x) const;

    struct Nearest
    {
      unsigned int edge     = 0;
      double       s        = 0; // where on its chord
      double       distance = std::numeric_limits<double>::max();
    };
    /// The place on the chords that is nearest to x.
    Nearest nearest(const dealii::Point<2> &x) const;

    const std::vector<mechanics::SurfaceEdge<2>> &edges;
    const EdgeTree                                tree;

  private:
    double right; // end
  };

  /// The whole boundary of a body, holes included.
  template <class Part>
  class ClosedSurface;

  template <>
  class ClosedSurface<mechanics::SurfaceEdge<2>> : public ClosedOutline
  {
  public:
    using ClosedOutline::ClosedOutline;
  };

  /// Boxes around facets.
  BoxTree<3> facet_tree(const std::vector<mechanics::SurfaceFacet> &facets);

  template <>
  class ClosedSurface<mechanics::SurfaceFacet>
  {
  public:
    /// @param facets are not copied.
    explicit ClosedSurface(const std::vector<mechanics::SurfaceFacet> &facets)
      : facets(facets)
    {}

    /// Is x inside? By the solid angle of the surface (van Oosterom, Strackee 1983).
    bool contains(const dealii::Point<3> &x) const;

  private:
    const std::vector<mechanics::SurfaceFacet> &facets;
  };
} // namespace slipstick::interface
