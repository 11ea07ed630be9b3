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
} // namespace slipstick::interface
