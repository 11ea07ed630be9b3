#include <slipstick/interface/edge_tree.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace slipstick::interface
{
  namespace
  {
    std::vector<EdgeTree::Box> boxes(const std::vector<mechanics::SurfaceEdge<2>> &edges)
    {
      std::vector<EdgeTree::Box> all;
      for (const auto &edge : edges)
        all.push_back(EdgeTree::box_around(edge));
      return all;
    }
  } // namespace

  EdgeTree::EdgeTree(const std::vector<mechanics::SurfaceEdge<2>> &edges)
    : BoxTree<2>(boxes(edges))
  {}

  EdgeTree::Box EdgeTree::box_around(const mechanics::SurfaceEdge<2> &edge)
  {
    std::vector<dealii::Point<2>> points = {edge.node(0), edge.node(1)};
    if (edge.n_nodes == 3) // control point of the parabola
      points.emplace_back(2. * edge.node(2) - 0.5 * (edge.node(0) + dealii::Tensor<1, 2>(edge.node(1))));
    return box_around(points);
  }

  ClosedOutline::ClosedOutline(const std::vector<mechanics::SurfaceEdge<2>> &edges)
    : edges(edges)
    , tree(edges)
    , right(std::numeric_limits<double>::lowest())
  {
    for (const auto &edge : edges)
      right = std::max(right, EdgeTree::box_around(edge).max_corner().get<0>());
  }

  bool ClosedOutline::contains(const dealii::Point<2> &x) const
  {
    bool inside = false;
    if (x[0] <= right)
      for (const unsigned int e : tree.near({{x[0], x[1]}, {right, x[1]}}))
        {
          const auto a = edges[e].node(0), b = edges[e].node(1);
          if ((a[1] > x[1]) != (b[1] > x[1]) && x[0] < a[0] + (x[1] - a[1]) / (b[1] - a[1]) * (b[0] - a[0]))
            inside = !inside;
        }
    return inside;
  }

  ClosedOutline::Nearest ClosedOutline::nearest(const dealii::Point<2> &x) const
  {
    Nearest best;
    tree.for_each_by_distance(
      x,
      [&] { return best.distance; },
      [&](const unsigned int e) {
        const auto   a = edges[e].node(0), b = edges[e].node(1);
        const double s        = std::min(1., std::max(0., (x - a) * (b - a) / (b - a).norm_square()));
        const double distance = x.distance(a + s * (b - a));
        if (distance < best.distance)
          best = {e, s, distance};
        return true;
      });
    return best;
  }

  bool ClosedSurface<mechanics::SurfaceFacet>::contains(const dealii::Point<3> &x) const
  {
    double angle = 0;
    for (const auto &facet : facets)
      for (unsigned int k = 1; k + 1 < facet.n_nodes; ++k)
        {
          const auto a = facet.node(0) - x, b = facet.node(k) - x, c = facet.node(k + 1) - x;
          angle +=
            2 * std::atan2(a * cross_product_3d(b, c),
                           a.norm() * b.norm() * c.norm() + a * b * c.norm() + b * c * a.norm() + c * a * b.norm());
        }
    return angle > 2 * dealii::numbers::PI;
  }
} // namespace slipstick::interface
