// Gaps between edges that represent curves.
#include "curves.h"

#include <gtest/gtest.h>

using namespace slipstick;
using namespace slipstick::test;

namespace
{
  std::vector<Edge> with_arcs(std::vector<Edge> edges)
  {
    for (auto &edge : edges)
      edge.curve = mesh::EdgeCurve<2>::arc(edge.node(0), edge.node(1), dealii::Point<2>());
    return edges;
  }

  std::vector<interface::MortarRow<2>> rows(
    const std::vector<Edge>           &slave,
    const std::vector<Edge>           &master,
    const scene::ContactDiscretization how = scene::ContactDiscretization::mortar) {
    return interface::mortar_rows(slave, master, {0.2, 0.2}, how, "pair");
  }
} // namespace

TEST(CurvedGap, is_zero_between_equal_circles_whose_nodes_do_not_match)
{
  for (const unsigned int degree : {1, 2})
    for (const double end : {340., 301.}) // whole edges, and one that is covered in part
      {
        const auto slave = arc(1, 200, 340, 9, degree, 0), master = arc(1, end, 190, 11, degree, 1000);
        const auto polygons = rows(slave, master), curves = rows(with_arcs(slave), with_arcs(master));
        ASSERT_EQ(polygons.size(), curves.size());
        double largest = 0;
        for (unsigned int i = 0; i < curves.size(); ++i)
          {
            largest = std::max(largest, std::abs(polygons[i].gap));
            EXPECT_NEAR(curves[i].gap, 0, 2e-11);
            // weights are those of the edges
            ASSERT_EQ(polygons[i].master_weights.size(), curves[i].master_weights.size());
            for (unsigned int k = 0; k < curves[i].master_weights.size(); ++k)
              EXPECT_NEAR(polygons[i].master_weights[k].second, curves[i].master_weights[k].second, 1e-2);
          }
        EXPECT_GT(largest, degree == 1 ? 1e-3 : 5e-6);
      }
}

TEST(CurvedGap, between_concentric_circles_converges)
{
  for (const double radius : {1.01, 0.99})
    for (const unsigned int n : {9, 18})
      for (const auto &row :
           rows(with_arcs(arc(1, 200, 340, n, 1, 0)), with_arcs(arc(radius, 350, 190, n + n / 3, 1, 1000))))
        EXPECT_NEAR(row.gap, radius - 1, 0.1 * std::abs(radius - 1) * (9. / n) * (9. / n));
}

TEST(CurvedGap, sees_curves_over_straight_edges_of_degree_two)
{
  // mid nodes on the chords, as for cells too thin to be bent
  auto slave = with_arcs(arc(1, 200, 340, 9, 1, 0)), master = with_arcs(arc(1.01, 340, 200, 9, 1, 1000));
  for (auto *side : {&slave, &master})
    for (auto &edge : *side)
      {
        const auto x = edge.node(0) + 0.5 * (edge.node(1) - edge.node(0));
        edge.n_nodes = 3;
        edge.keys[2] = {{std::min(edge.keys[0][0], edge.keys[1][0]), std::max(edge.keys[0][0], edge.keys[1][0])}};
        edge.at[2]   = {{x[0], x[1]}};
      }
  for (const auto how : {scene::ContactDiscretization::mortar, scene::ContactDiscretization::node_to_node})
    for (const auto &row : rows(slave, master, how))
      EXPECT_NEAR(row.gap, 0.01, 1e-4);
}
