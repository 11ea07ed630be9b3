#include "curves.h"
#include "rotation.h"

#include <slipstick/base/exceptions.h>

#include <gtest/gtest.h>

#include <map>

using namespace slipstick;
using namespace slipstick::test;
using scene::ContactDiscretization;
using Point = dealii::Point<2>;

namespace
{
  using Rows = std::vector<interface::MortarRow<2>>;

  Rows rows(const std::vector<Edge>    &slave,
            const std::vector<Edge>    &master,
            const double                reach          = 1,
            const ContactDiscretization discretization = ContactDiscretization::mortar)
  {
    return interface::mortar_rows(slave, master, {reach, reach}, discretization, "pair");
  }

  /// Bottom of a body above: the slave runs to the right, the master to the left.
  std::vector<Edge> bottom(const double       from,
                           const double       to,
                           const unsigned int n,
                           const unsigned int degree,
                           const double       y = 0)
  {
    return line({from, y}, {to, y}, n, degree, 0);
  }
  std::vector<Edge> top(const double       from,
                        const double       to,
                        const unsigned int n,
                        const unsigned int degree,
                        const double       y = 0)
  {
    return line({to, y}, {from, y}, n, degree, 1000);
  }

  double sum(const interface::Weights &weights)
  {
    double s = 0;
    for (const auto &[key, weight] : weights)
      s += weight;
    return s;
  }

  std::map<mechanics::NodeKey, Point> positions(const std::vector<Edge> &edges)
  {
    std::map<mechanics::NodeKey, Point> at;
    for (const auto &edge : edges)
      for (unsigned int i = 0; i < edge.n_nodes; ++i)
        at[edge.keys[i]] = edge.node(i);
    return at;
  }

  /// Nodal forces of a uniform pressure 1, i.e. of multipliers equal to the lengths, on either side.
  std::map<mechanics::NodeKey, double> forces_of_pressure(const Rows &all, const bool of_slave)
  {
    std::map<mechanics::NodeKey, double> force;
    for (const auto &row : all)
      for (const auto &[key, weight] : of_slave ? row.slave_weights : row.master_weights)
        force[key] += weight * row.length;
    return force;
  }

  /// Integrals of shape functions over x in [from, to] of edges along y = const.
  std::map<mechanics::NodeKey, double> exact_forces(const std::vector<Edge> &edges, const double from, const double to)
  {
    std::map<mechanics::NodeKey, double> force;
    for (const auto &edge : edges)
      {
        const double x0 = edge.node(0)[0], length = edge.node(1)[0] - x0;
        double       a = (from - x0) / length, b = (to - x0) / length;
        if (a > b)
          std::swap(a, b);
        a = std::max(0., a);
        b = std::min(1., b);
        if (a >= b)
          continue;
        for (unsigned int i = 0; i < edge.n_nodes; ++i) // Simpson is exact for quadratics
          force[edge.keys[i]] +=
            std::abs(length) * (b - a) / 6 * (edge.shape(a)[i] + 4 * edge.shape((a + b) / 2)[i] + edge.shape(b)[i]);
      }
    return force;
  }

  void expect_same(const std::map<mechanics::NodeKey, double> &found,
                   const std::map<mechanics::NodeKey, double> &expect,
                   const double                                tolerance)
  {
    for (const auto &[key, value] : expect)
      if (std::abs(value) > tolerance)
        {
          ASSERT_EQ(found.count(key), 1u) << key[0] << ' ' << key[1];
          EXPECT_NEAR(found.at(key), value, tolerance) << key[0] << ' ' << key[1];
        }
    for (const auto &[key, value] : found)
      EXPECT_NEAR(value, expect.count(key) ? expect.at(key) : 0., tolerance);
  }
} // namespace

TEST(Mortar, integrals_of_two_linear_edges_on_one)
{
  // slave [0, 2] on masters [0, 1], [1, 2]: phi_1 = 2 N_1 - N_2, phi_2 = 2 N_2 - N_1; by hand
  const auto all = rows(bottom(0, 2, 1, 1), top(0, 2, 2, 1));
  ASSERT_EQ(all.size(), 2u);
  EXPECT_NEAR(all[0].length, 1, 1e-14);
  const std::map<mechanics::NodeKey, double> weights(all[0].master_weights.begin(), all[0].master_weights.end());
  // masters: 1002 at x = 0, 1001 at x = 1, 1000 at x = 2
  EXPECT_NEAR(weights.at({{1002, 1002}}), 0.75, 1e-14);
  EXPECT_NEAR(weights.at({{1001, 1001}}), 0.5, 1e-14);
  EXPECT_NEAR(weights.at({{1000, 1000}}), -0.25, 1e-14);
}

TEST(Mortar, whole_quadratic_edge_has_lengths_one_four_one_sixth)
{
  const auto all = rows(bottom(0, 3, 1, 2), top(0, 3, 2, 2));
  ASSERT_EQ(all.size(), 3u);
  EXPECT_NEAR(all[0].length, 0.5, 1e-14);
  EXPECT_NEAR(all[1].length, 2, 1e-14); // the node {0, 1} in the middle
  EXPECT_NEAR(all[2].length, 0.5, 1e-14);
}

TEST(Mortar, weights_sum_to_one)
{
  for (const unsigned int degree : {1, 2})
    for (const auto &all : {rows(bottom(0, 1, 7, degree), top(-0.13, 0.77, 5, degree)),
                            rows(arc(1, 200, 340, 9, degree, 0), arc(1.05, 350, 190, 11, degree, 1000)),
                            rows(arc(1, 200, 340, 9, degree, 0), arc(0.95, 330, 190, 11, degree, 1000))})
      {
        EXPECT_GT(all.size(), 5u);
        for (const auto &row : all)
          {
            EXPECT_NEAR(sum(row.slave_weights), 1, 4e-16);
            EXPECT_NEAR(sum(row.master_weights), 1, 4e-16);
          }
      }
}

TEST(Mortar, equal_pressure_acts_alike_on_both_sides_at_overhangs_too)
{
  for (const unsigned int degree : {1, 2})
    for (const auto &[from, to] :
         std::vector<std::pair<double, double>>{{0, 1}, {-0.3, 0.8}, {0.21, 0.77}, {0.2, 0.6}, {0.1, 3}, {0.999, 2}})
      {
        const auto   slave = bottom(0, 1, 5, degree), master = top(from, to, 4, degree);
        const auto   all = rows(slave, master);
        const double a = std::max(0., from), b = std::min(1., to);
        expect_same(forces_of_pressure(all, true), exact_forces(slave, a, b), 2e-11);
        expect_same(forces_of_pressure(all, false), exact_forces(master, a, b), 2e-11);
      }
}

TEST(Mortar, linear_displacements_of_the_master_pass_to_the_slave)
{
  for (const unsigned int degree : {1, 2})
    for (const double to : {1., 0.83, 0.61})
      {
        const auto slave = bottom(0, 1, 5, degree), master = top(0, to, 7, degree, -0.1);
        const auto x = positions(slave), y = positions(master);
        for (const auto &row : rows(slave, master))
          {
            double left = 0, right = 0;
            for (const auto &[key, weight] : row.slave_weights)
              left += weight * (3 + 2 * x.at(key)[0]);
            for (const auto &[key, weight] : row.master_weights)
              right += weight * (3 + 2 * y.at(key)[0]);
            EXPECT_NEAR(left, right, 1e-9) << degree << ' ' << to;
          }
      }
}

TEST(Mortar, matching_meshes_give_node_to_node_rows)
{
  for (const unsigned int degree : {1, 2})
    for (const auto discretization :
         {ContactDiscretization::automatic, ContactDiscretization::mortar, ContactDiscretization::node_to_node})
      for (const double y : {0., -0.1, 0.1})
        for (const auto &row : rows(bottom(0, 1, 6, degree), top(0, 1, 6, degree, y), 1, discretization))
          {
            ASSERT_EQ(row.slave_weights.size(), 1u);
            ASSERT_EQ(row.master_weights.size(), 1u);
            EXPECT_EQ(row.slave_weights[0].first, row.slave);
            EXPECT_EQ(row.master_weights[0].second, 1);
            EXPECT_NEAR(row.master_position[0], row.position[0], 1e-14);
            EXPECT_NEAR(row.gap, -y, 1e-14);
          }
}

TEST(Mortar, automatic_is_node_to_node_on_matching_circles_with_a_gap)
{
  const auto closed = [](std::vector<Edge> edges) {
    edges.back().keys[1] = edges.front().keys[0];
    return edges;
  };
  for (const unsigned int degree : {1, 2})
    for (const double radius : {1., 1.02, 0.97})
      {
        const auto all = rows(closed(arc(1, 0, 360, 24, degree, 0)),
                              closed(arc(radius, 360, 0, 24, degree, 1000)),
                              0.5,
                              ContactDiscretization::automatic);
        EXPECT_EQ(all.size(), 24 * degree);
        for (const auto &row : all)
          {
            EXPECT_EQ(row.master_weights.size(), 1u);
            EXPECT_NEAR(row.gap, radius - 1, 1e-13);
          }
      }
}

TEST(Mortar, node_to_node_on_meshes_that_do_not_match_is_refused)
{
  try
    {
      rows(bottom(0, 1, 6, 1), top(0, 1, 5, 1), 1, ContactDiscretization::node_to_node);
      FAIL();
    }
  catch (const InputError &error)
    {
      for (const std::string part : {"Contact pair", "node to node", "do not match", "mortar"})
        EXPECT_NE(std::string(error.what()).find(part), std::string::npos) << error.what();
    }
}

TEST(Mortar, gaps_of_concentric_arcs_converge)
{
  for (const double radius : {1.03, 0.96})
    for (const unsigned int degree : {1, 2})
      {
        double previous = 1;
        for (const unsigned int n : {9, 18, 36})
          {
            double error = 0;
            for (const auto &row : rows(arc(1, 200, 340, n, degree, 0), arc(radius, 350, 190, n + n / 3, degree, 1000)))
              error = std::max(error, std::abs(row.gap - (radius - 1)));
            EXPECT_LT(error, previous / 3);
            previous = error;
          }
        EXPECT_LT(previous, 1e-3);
      }
}

TEST(Mortar, order_of_edges_does_not_matter)
{
  for (const unsigned int degree : {1, 2})
    {
      auto       slave = bottom(0, 1, 7, degree), master = top(-0.2, 0.9, 5, degree, 0.02);
      const auto expect = rows(slave, master);
      std::reverse(slave.begin(), slave.end());
      std::reverse(master.begin(), master.end());
      const auto found = rows(slave, master);
      ASSERT_EQ(found.size(), expect.size());
      for (unsigned int i = 0; i < found.size(); ++i)
        {
          EXPECT_EQ(found[i].slave, expect[i].slave);
          EXPECT_NEAR(found[i].length, expect[i].length, 1e-14);
          EXPECT_NEAR(found[i].gap, expect[i].gap, 1e-13);
          ASSERT_EQ(found[i].master_weights.size(), expect[i].master_weights.size());
        }
    }
}

TEST(Mortar, what_is_out_of_reach_has_no_rows)
{
  EXPECT_TRUE(rows(bottom(0, 1, 4, 1), top(0, 1, 4, 1, -0.5), 0.4).empty());
  EXPECT_EQ(rows(bottom(0, 1, 4, 1), top(0, 1, 4, 1, -0.5), 0.6).size(), 5u);
}

TEST(Mortar, far_sides_of_thin_bodies_are_no_partners)
{
  // body above: top at 0.1, bottom at 0, all outline; body below: top at -0.05 and bottom at -0.15
  auto above = bottom(0, 1, 4, 1), below = top(0, 1, 5, 1, -0.05);
  for (const auto &edge : line({1, 0.1}, {0, 0.1}, 4, 1, 100))
    above.push_back(edge);
  for (const auto &edge : line({0, -0.15}, {1, -0.15}, 5, 1, 2000))
    below.push_back(edge);
  const auto all = rows(above, below, 1);
  EXPECT_EQ(all.size(), 5u);
  for (const auto &row : all)
    EXPECT_NEAR(row.gap, 0.05, 1e-13);
}

TEST(Mortar, corner_of_the_slave_has_a_row_for_each_side)
{
  // a square corner of the slave at the origin in an equal corner of the master
  auto slave  = line({0, 1}, {0, 0}, 3, 1, 0);
  auto second = line({0, 0}, {1, 0}, 3, 1, 3);
  slave.insert(slave.end(), second.begin(), second.end());
  auto master = line({1, -0.01}, {-0.01, -0.01}, 4, 1, 1000);
  second      = line({-0.01, -0.01}, {-0.01, 1}, 4, 1, 1004);
  master.insert(master.end(), second.begin(), second.end());
  unsigned int at_corner = 0;
  for (const auto &row : rows(slave, master))
    {
      EXPECT_NEAR(row.gap, 0.01, 1e-13);
      at_corner += row.slave == mechanics::NodeKey{{3, 3}};
    }
  EXPECT_EQ(at_corner, 2u);
}

// with their own normals, both curves would be inclined by x / radius, and closing the gap would look like slip
TEST(Mortar, equal_arcs_touch_along_their_plane_of_symmetry)
{
  const auto lower = arc(1, 50, 130, 32, 1, 0);
  auto       upper = arc(1, 230, 310, 32, 1, 1000);
  for (auto &edge : upper)
    for (unsigned int i = 0; i < edge.n_nodes; ++i)
      edge.at[i][1] += 2;
  for (const auto &all : {rows(upper, lower), rows(lower, upper)})
    {
      unsigned int n = 0;
      for (const auto &row : all)
        if (const double x = std::abs(row.position[0]); x > 0.05 && x < 0.4)
          {
            // the ray along the slave's own normal meets the master 2 gap x / radius to the side
            const double gap = 2 * (1 - std::sqrt(1 - x * x));
            EXPECT_LT(std::abs(row.normal[0]), 1.2 * gap * x);
            ++n;
          }
      EXPECT_GE(n, 16u);
    }
}

TEST(Mortar, normals_are_means_of_both_sides)
{
  for (const unsigned int degree : {1, 2})
    {
      unsigned int n = 0;
      for (const auto &row : rows(arc(1, 200, 340, 40, degree, 0), line({3, -1}, {-3, -1}, 7, degree, 1000), 4))
        if (std::abs(row.position[0]) < 0.9) // the nodes at the ends have one edge, whose normal is more inclined
          {
            const auto sum = row.position + dealii::Tensor<1, 2>({0, -1});
            EXPECT_LT((row.normal - sum / sum.norm()).norm(), 1e-3) << row.position;
            ++n;
          }
      EXPECT_GE(n, 30u);
    }
}

TEST(Mortar, distance_where_curves_face_each_other)
{
  EXPECT_NEAR(*interface::facing_distance(bottom(0, 1, 4, 1), top(0, 1, 3, 1, -0.3)), 0.3, 1e-14);
  EXPECT_NEAR(*interface::facing_distance(bottom(0, 1, 4, 1), top(1.4, 2, 3, 1, -0.3)), 0.5, 1e-14);
  EXPECT_FALSE(interface::facing_distance(bottom(0, 1, 4, 1), bottom(0, 1, 4, 1, -0.3)));
}

TEST(Mortar, moments_of_the_sides_agree_to_the_square_of_the_mesh_size)
{
  for (const unsigned int degree : {1, 2})
    {
      double previous = 0;
      for (const unsigned int n : {9, 18, 36})
        {
          const auto slave = arc(1, 200, 340, n, degree, 0), master = arc(1.04, 350, 190, n + n / 3, degree, 1000);
          const auto x = positions(slave), y = positions(master);
          double     moment = 0;
          for (const auto &row : rows(slave, master))
            {
              const double pressure = row.length * (1 + row.position[0]);
              const auto   torque   = [&](const interface::Weights                  &weights,
                                      const std::map<mechanics::NodeKey, Point> &at) {
                double m = 0;
                for (const auto &[key, weight] : weights)
                  m += weight * (at.at(key)[0] * row.normal[1] - at.at(key)[1] * row.normal[0]);
                return m;
              };
              moment += pressure * (torque(row.slave_weights, x) - torque(row.master_weights, y));
            }
          if (previous > 0)
            {
              EXPECT_LT(std::abs(moment), std::abs(previous) / 3 + 1e-14);
            }
          previous = std::abs(moment);
        }
      EXPECT_LT(previous, 1e-4);
    }
}

// Arcs that are apart by two cells, or touch in one point; matching nodes are opposite each other.
TEST(Mortar, rows_across_gaps_resist_no_rotation)
{
  for (const unsigned int degree : {1, 2})
    for (const auto discretization : {ContactDiscretization::mortar, ContactDiscretization::automatic})
      for (const unsigned int n : {12, 16})
        for (const double radius : {1.0, 1.02, 1.5})
          {
            const auto slave = arc(1, 200, 340, 12, degree, 0), master = arc(radius, 340, 200, n, degree, 1000);
            expect_no_resistance_to_rotations<2>(rows(slave, master, 1, discretization), slave, master, radius > 1);
          }
}

// A master with a step from 0 down to -0.5, within a slave edge or at a node of it; steep flanks are steps, too.
TEST(Mortar, only_the_nearest_level_counts)
{
  for (const unsigned int degree : {1, 2})
    for (const double step : {0.3, 0.5, 0.55, 0.7})
      for (const double width : {0., 0.02})
        {
          auto high = top(-0.2, step, 3, degree), low = line({1.2, -0.5}, {step + width, -0.5}, 4, degree, 2000);
          high.insert(high.end(), low.begin(), low.end());
          if (width > 0)
            for (const auto &edge : line({step + width, -0.5}, {step, 0}, 1, degree, 3000))
              high.push_back(edge);
          const auto all = rows(bottom(0, 1, 4, degree), high, 1);
          EXPECT_GE(all.size(), 5u); // all nodes, but midside nodes of edges that are covered in part
          for (const auto &row : all)
            {
              const double x = row.position[0], start = 0.25 * std::floor((x - 1e-12) / 0.25); // of its edge
              EXPECT_NEAR(row.gap, start < step - 1e-12 ? 0 : 0.5, 1e-12) << x << ' ' << step << ' ' << width;
            }
        }
}

TEST(Mortar, gaps_that_change_steadily_are_one_level)
{
  const auto slave = arc(1, 200, 340, 12, 1, 0), master = arc(1.3, 350, 190, 17, 1, 1000);
  const auto all = rows(slave, master);
  EXPECT_EQ(all.size(), 13u);
  for (const auto &row : all)
    EXPECT_NEAR(row.measure, row.full_measure, 1e-12);
}
