#include <slipstick/interface/edge_tree.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace slipstick::interface
{
  namespace
  {
    using Entry = std::pair<EdgeTree::Box, unsigned int>;

    std::vector<Entry> entries(const std::vector<mechanics::SurfaceEdge<2>> &edges)
    {
      std::vector<Entry> all;
      for (unsigned int e = 0; e < edges.size(); ++e)
        all.emplace_back(EdgeTree::box_around(edges[e]), e);
      return all;
    }
  } // namespace

  EdgeTree::EdgeTree(const std::vector<mechanics::SurfaceEdge<2>> &edges)
    : tree(entries(edges))
  {}

  std::vector<unsigned int> EdgeTree::near(const Box &box) const
  {
    std::vector<unsigned int> found;
    for (auto at = tree.qbegin(boost::geometry::index::intersects(box)); at != tree.qend(); ++at)
      found.push_back(at->second);
    std::sort(found.begin(), found.end());
    return found;
  }

  double EdgeTree::distance(const dealii::Point<2> &x, const Box &box)
  {
    const double dx = std::max({box.min_corner().get<0>() - x[0], x[0] - box.max_corner().get<0>(), 0.});
    const double dy = std::max({box.min_corner().get<1>() - x[1], x[1] - box.max_corner().get<1>(), 0.});
    return std::hypot(dx, dy);
  }

  std::vector<std::pair<double, unsigned int>> EdgeTree::nearest(const dealii::Point<2> &x, const std::size_t n) const
  {
    std::vector<Entry> found;
    tree.query(boost::geometry::index::nearest(Place(x[0], x[1]), n), std::back_inserter(found));
    std::vector<std::pair<double, unsigned int>> sorted;
    for (const auto &[box, edge] : found)
      sorted.emplace_back(distance(x, box), edge);
    std::sort(sorted.begin(), sorted.end());
    return sorted;
  }

  EdgeTree::Box EdgeTree::box_around(const std::vector<dealii::Point<2>> &points)
  {
    dealii::Point<2> low = points[0], high = points[0];
    for (const auto &x : points)
      for (unsigned int d = 0; d < 2; ++d)
        {
          low[d]  = std::min(low[d], x[d]);
          high[d] = std::max(high[d], x[d]);
        }
    return {{low[0], low[1]}, {high[0], high[1]}};
  }

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
} // namespace slipstick::interface
