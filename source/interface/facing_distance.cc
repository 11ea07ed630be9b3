#include <slipstick/base/nearest.h>
#include <slipstick/interface/edge_tree.h>
#include <slipstick/interface/facing_distance.h>

#include <algorithm>

namespace slipstick::interface
{
  namespace
  {
    double distance_to(const mechanics::SurfaceEdge<2> &edge, const dealii::Point<2> &x)
    {
      return x.distance(nearest_on_segment(edge.node(0), edge.node(1), x));
    }

    double distance_to(const mechanics::SurfaceFacet &facet, const dealii::Point<3> &x)
    {
      return facet.distance(x);
    }

    std::vector<double> sample_places(const mechanics::SurfaceEdge<2> &)
    {
      return {0., 0.5, 1.};
    }

    std::vector<mechanics::SurfaceFacet::Place> sample_places(const mechanics::SurfaceFacet &facet)
    {
      std::vector<mechanics::SurfaceFacet::Place> places;
      for (unsigned int i = 0; i < facet.n_nodes; ++i)
        places.push_back(facet.node_coordinate(i));
      places.push_back(facet.middle_place());
      return places;
    }

    EdgeTree tree_of(const std::vector<mechanics::SurfaceEdge<2>> &edges)
    {
      return EdgeTree(edges);
    }

    BoxTree<3> tree_of(const std::vector<mechanics::SurfaceFacet> &facets)
    {
      return facet_tree(facets);
    }

    template <class Part>
    void one_way(const std::vector<Part> &a, const std::vector<Part> &b, double &smallest)
    {
      const auto tree = tree_of(b);
      for (const auto &part : a)
        for (const auto &s : sample_places(part))
          {
            const auto x = part.point(s);
            const auto n = part.normal(s);
            tree.for_each_by_distance(
              x,
              [&] { return smallest; },
              [&](const unsigned int m) {
                if (middle_normal(b[m]) * n < facing_cosine)
                  smallest = std::min(smallest, distance_to(b[m], x));
                return true;
              });
          }
    }
  } // namespace

  template <class Part>
  std::optional<double> facing_distance(const std::vector<Part> &a, const std::vector<Part> &b, const double bound)
  {
    double smallest = bound;
    one_way(a, b, smallest);
    one_way(b, a, smallest);
    if (smallest < bound)
      return smallest;
    return {};
  }

  template std::optional<double> facing_distance(const std::vector<mechanics::SurfaceEdge<2>> &,
                                                 const std::vector<mechanics::SurfaceEdge<2>> &,
                                                 const double);
  template std::optional<double> facing_distance(const std::vector<mechanics::SurfaceFacet> &,
                                                 const std::vector<mechanics::SurfaceFacet> &,
                                                 const double);
} // namespace slipstick::interface
