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

    /// Bounding box of an edge (of the Bezier points of curved ones).
    static Box box_around(const mechanics::SurfaceEdge<2> &edge);
  };

  /// The whole outline of a body, including holes; curved edges are replaced by their chords.
  class ClosedOutline
  {
  public:
    /// @param edges are kept by reference.
    explicit ClosedOutline(const std::vector<mechanics::SurfaceEdge<2>> &edges);

    /// Whether x is inside, by counting crossings of the ray along +x.
    bool contains(const dealii::Point<2> &x) const;

    struct Nearest
    {
      unsigned int edge     = 0;
      double       s        = 0; // local coordinate on the chord
      double       distance = std::numeric_limits<double>::max();
    };
    /// The point on the chords nearest to x.
    Nearest nearest(const dealii::Point<2> &x) const;

    const std::vector<mechanics::SurfaceEdge<2>> &edges;
    const EdgeTree                                tree;

  private:
    double right; // right end
  };

  /// The whole boundary of a body, including holes.
  template <class Part>
  class ClosedSurface;

  template <>
  class ClosedSurface<mechanics::SurfaceEdge<2>> : public ClosedOutline
  {
  public:
    using ClosedOutline::ClosedOutline;
  };

  template <>
  class ClosedSurface<mechanics::SurfaceFacet>
  {
  public:
    /// @param facets are kept by reference.
    explicit ClosedSurface(const std::vector<mechanics::SurfaceFacet> &facets)
      : facets(facets)
    {}

    /// Whether x is inside, by the solid angle of the surface (van Oosterom, Strackee 1983).
    bool contains(const dealii::Point<3> &x) const;

  private:
    const std::vector<mechanics::SurfaceFacet> &facets;
  };
} // namespace slipstick::interface
