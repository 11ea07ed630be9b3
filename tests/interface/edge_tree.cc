#include "curves.h"

#include <slipstick/interface/edge_tree.h>

#include <gtest/gtest.h>

using namespace slipstick;
using namespace slipstick::test;

namespace
{
  /// The edges within a radius, in the order in which the tree gives them.
  std::vector<unsigned int> order(const interface::EdgeTree &tree, const dealii::Point<2> &x, const double radius)
  {
    std::vector<unsigned int> found;
    tree.for_each_by_distance(
      x,
      [&] { return radius; },
      [&](const unsigned int e) {
        found.push_back(e);
        return true;
      });
    return found;
  }

  double distance(const Edge &edge, const dealii::Point<2> &x)
  {
    const auto   box = interface::EdgeTree::box_around(edge);
    const double dx  = std::max({box.min_corner().get<0>() - x[0], x[0] - box.max_corner().get<0>(), 0.});
    const double dy  = std::max({box.min_corner().get<1>() - x[1], x[1] - box.max_corner().get<1>(), 0.});
    return std::hypot(dx, dy);
  }

  std::vector<unsigned int> expected(const std::vector<Edge> &edges, const dealii::Point<2> &x, const double radius)
  {
    std::vector<std::pair<double, unsigned int>> all;
    for (unsigned int e = 0; e < edges.size(); ++e)
      if (distance(edges[e], x) <= radius)
        all.emplace_back(distance(edges[e], x), e);
    std::sort(all.begin(), all.end());
    std::vector<unsigned int> numbers;
    for (const auto &one : all)
      numbers.push_back(one.second);
    return numbers;
  }
} // namespace

TEST(EdgeTree, edges_come_by_distance_each_once)
{
  const auto closed = arc(1, 0, 360, 40, 1, 0);
  const auto flat   = line({0, 0}, {1, 0}, 37, 1, 0);
  for (const auto &edges : {closed, flat, std::vector<Edge>{flat[0]}, std::vector<Edge>()})
    {
      const interface::EdgeTree tree(edges);
      // many edges are equally far from the centre of the circle
      for (const dealii::Point<2> &x : {dealii::Point<2>(0, 0), dealii::Point<2>(0.3, 0.2), dealii::Point<2>(-2, 0)})
        for (const double radius : {0., 0.5, 1., 1.2, 10.})
          EXPECT_EQ(order(tree, x, radius), expected(edges, x, radius)) << x << ' ' << radius;
    }
}

TEST(EdgeTree, search_stops_when_told)
{
  const auto                edges = line({0, 0}, {1, 0}, 37, 1, 0);
  const interface::EdgeTree tree(edges);
  unsigned int              n = 0;
  tree.for_each_by_distance(
    dealii::Point<2>(-1, 0),
    [] { return 10.; },
    [&](const unsigned int e) {
      EXPECT_EQ(e, n);
      return ++n < 7;
    });
  EXPECT_EQ(n, 7u);
}
