#include "rotation.h"

#include <slipstick/interface/facing_distance.h>
#include <slipstick/interface/mortar.h>

#include <gtest/gtest.h>

#include <cmath>
#include <functional>

using namespace slipstick;
using scene::ContactDiscretization;

namespace
{
  using Facet  = mechanics::SurfaceFacet;
  using Point  = dealii::Point<3>;
  using Tensor = dealii::Tensor<1, 3>;
  using Rows   = std::vector<interface::MortarRow<3>>;

  /// Keys of the second of two bodies start here.
  constexpr std::uint64_t of_master = 100000;

  /// n x m quadrilaterals, or twice as many triangles, whose corners are at @p place of (0..1, 0..1); normals are along
  /// d place / ds x d place / dt, or against it.
  std::vector<Facet> surface(const unsigned int                                      n,
                             const unsigned int                                      m,
                             const std::function<Point(const double, const double)> &place,
                             const bool                                              is_reversed,
                             const std::uint64_t                                     first_key,
                             const bool                                              is_split = false)
  {
    std::vector<Facet> facets;
    const auto         add = [&](std::vector<std::array<unsigned int, 2>> corners) {
      if (is_reversed)
        std::reverse(corners.begin(), corners.end());
      Facet facet;
      facet.n_nodes = corners.size();
      for (unsigned int i = 0; i < corners.size(); ++i)
        {
          const auto [a, b]       = corners[i];
          const Point         x   = place(double(a) / n, double(b) / m);
          const std::uint64_t key = first_key + a + (n + 1) * b;
          facet.keys[i]           = {{key, key}};
          facet.at[i]             = {{x[0], x[1], x[2]}};
        }
      facets.push_back(facet);
    };
    for (unsigned int b = 0; b < m; ++b)
      for (unsigned int a = 0; a < n; ++a)
        if (is_split)
          {
            add({{{a, b}}, {{a + 1, b}}, {{a + 1, b + 1}}});
            add({{{a, b}}, {{a + 1, b + 1}}, {{a, b + 1}}});
          }
        else
          add({{{a, b}}, {{a + 1, b}}, {{a + 1, b + 1}}, {{a, b + 1}}});
    return facets;
  }

  /// A rectangle at height z; inner corners are moved by @p distortion.
  std::function<Point(const double, const double)> rectangle(const double x0,
                                                             const double x1,
                                                             const double y0,
                                                             const double y1,
                                                             const double z,
                                                             const double distortion = 0)
  {
    return [=](const double s, const double t) {
      const double bubble = 16 * s * (1 - s) * t * (1 - t) * distortion;
      return Point(x0 + (s + bubble) * (x1 - x0), y0 + (t - 0.7 * bubble) * (y1 - y0), z);
    };
  }

  Rows rows(const std::vector<Facet>   &slave,
            const std::vector<Facet>   &master,
            const ContactDiscretization discretization = ContactDiscretization::mortar)
  {
    return interface::mortar_rows(slave, master, {1., 1.}, discretization, "pair");
  }

  std::map<mechanics::NodeKey, Point> positions(const std::vector<Facet> &facets)
  {
    std::map<mechanics::NodeKey, Point> at;
    for (const auto &facet : facets)
      for (unsigned int i = 0; i < facet.n_nodes; ++i)
        at[facet.keys[i]] = facet.node(i);
    return at;
  }

  double sum(const interface::Weights &weights)
  {
    double s = 0;
    for (const auto &[key, weight] : weights)
      s += weight;
    return s;
  }

  /// Properties of the rows of parallel plane surfaces, however their meshes cover each other.
  void expect_consistent(const std::vector<Facet> &slave,
                         const std::vector<Facet> &master,
                         const double              gap,
                         const double              area,
                         const Point              &middle)
  {
    const auto at    = positions(slave);
    double     total = 0;
    Tensor     on_slave, on_master; // first moments of a uniform pressure
    const auto all = rows(slave, master);
    ASSERT_FALSE(all.empty());
    for (const auto &row : all)
      {
        EXPECT_NEAR(sum(row.slave_weights), 1, 1e-13);
        EXPECT_NEAR(sum(row.master_weights), 1, 1e-13);
        EXPECT_NEAR(row.gap, gap, 1e-12);
        EXPECT_NEAR(row.normal[2], -1, 1e-14);
        Tensor x;
        for (const auto &[key, weight] : row.slave_weights)
          x += weight * Tensor(at.at(key));
        // a field that is linear over both surfaces has no jump
        EXPECT_NEAR(x[0], row.master_position[0], 1e-10);
        EXPECT_NEAR(x[1], row.master_position[1], 1e-10);
        total += row.measure;
        on_slave += row.measure * x;
        on_master += row.measure * Tensor(row.master_position);
      }
    EXPECT_NEAR(total, area, 1e-12);
    for (unsigned int d = 0; d < 2; ++d)
      {
        EXPECT_NEAR(on_slave[d], area * middle[d], 1e-11);
        EXPECT_NEAR(on_master[d], area * middle[d], 1e-11);
      }
  }
} // namespace

// Slave [0, 1]^2 at z = 0 looks down on the master at z = -0.1; they overlap in [0.3, 1] x [0, 0.8].
TEST(SurfaceMortar, overhangs)
{
  for (const bool slave_triangles : {false, true})
    for (const bool master_triangles : {false, true})
      for (const double distortion : {0., 0.05})
        {
          const auto slave = surface(4, 3, rectangle(0, 1, 0, 1, 0, distortion), true, 0, slave_triangles);
          const auto master =
            surface(5, 4, rectangle(0.3, 1.7, -0.2, 0.8, -0.1, distortion), false, of_master, master_triangles);
          expect_consistent(slave, master, 0.1, 0.7 * 0.8, Point(0.65, 0.4, 0));
        }
}

// A master that covers a strip as thin as 1e-7 of the slave's facets.
TEST(SurfaceMortar, slivers)
{
  for (const double width : {0.2, 1e-3, 1e-5, 1e-7})
    {
      const auto slave  = surface(2, 2, rectangle(0, 1, 0, 1, 0, 0), true, 0);
      const auto master = surface(3, 3, rectangle(1 - width, 2, 0, 1, -0.1, 0), false, of_master);
      double     area   = 0;
      for (const auto &row : rows(slave, master))
        {
          area += row.measure;
          for (const auto &[key, weight] : row.slave_weights)
            EXPECT_LT(std::abs(weight), 100) << width;
        }
      EXPECT_NEAR(area, width, 1e-9); // nodes that are covered by less than 1e-10 have no row
    }
}

// The master ends on a mesh line of the slave, nearly: nodes beyond it saw gaps of 19 mm and -15 mm once.
TEST(SurfaceMortar, gaps_beside_slivers_are_those_of_the_sides)
{
  const auto slave = surface(4, 4, rectangle(-4, 4, -3, 3, 0), true, 0);
  for (const double beyond : {1e-7, 1e-5, 1e-4, 1e-3})
    {
      const auto crowned = [beyond](const double s, const double t) {
        const double x = (2 * s - 1) * (2 + beyond), y = 6 * t - 3;
        return Point(x, y, -0.01 - 0.002 * x * x - 0.005 * y * y);
      };
      const auto found = rows(slave, surface(3, 5, crowned, false, of_master));
      EXPECT_GE(found.size(), 15u) << beyond; // those of the nodes that the master covers
      for (const auto &row : found)
        {
          EXPECT_GT(row.gap, 0.) << beyond;
          EXPECT_LT(row.gap, 0.1) << beyond;
        }
    }
}

TEST(SurfaceMortar, of_layers_the_nearest_counts)
{
  const auto slave = surface(3, 3, rectangle(0, 1, 0, 1, 0), true, 0);
  auto       near  = surface(4, 4, rectangle(0, 1, 0, 1, -0.1), false, of_master);
  auto       far   = surface(5, 5, rectangle(0, 1, 0, 1, -0.2), false, 2 * of_master);
  for (const bool far_first : {false, true})
    {
      auto both = far_first ? far : near;
      both.insert(both.end(), far_first ? near.begin() : far.begin(), far_first ? near.end() : far.end());
      expect_consistent(slave, both, 0.1, 1, Point(0.5, 0.5, 0));
    }
  // of two layers at the same place only one counts
  auto       twice = near;
  const auto again = surface(4, 4, rectangle(0, 1, 0, 1, -0.1), false, 2 * of_master);
  twice.insert(twice.end(), again.begin(), again.end());
  expect_consistent(slave, twice, 0.1, 1, Point(0.5, 0.5, 0));
}

TEST(SurfaceMortar, sides_face_each_other)
{
  const auto slave = surface(3, 3, rectangle(0, 1, 0, 1, 0), true, 0);
  EXPECT_TRUE(rows(slave, surface(3, 3, rectangle(0, 1, 0, 1, -0.1), true, of_master)).empty());  // faces away
  EXPECT_TRUE(rows(slave, surface(3, 3, rectangle(0, 1, 0, 1, -1.1), false, of_master)).empty()); // out of reach
  EXPECT_TRUE(rows(slave, surface(3, 3, rectangle(2, 3, 0, 1, -0.1), false, of_master)).empty()); // beside it
  EXPECT_EQ(rows(slave, surface(3, 3, rectangle(0, 1, 0, 1, 0.1), false, of_master)).size(), 16); // overlaps
}

TEST(SurfaceMortar, matching_meshes_are_joined_node_to_node)
{
  const auto slave  = surface(3, 2, rectangle(0, 1, 0, 1, 0), true, 0);
  const auto master = surface(3, 2, rectangle(0, 1, 0, 1, -0.1), false, of_master);
  const auto all    = rows(slave, master, ContactDiscretization::automatic);
  ASSERT_EQ(all.size(), 12);
  for (const auto &row : all)
    {
      ASSERT_EQ(row.master_weights.size(), 1);
      EXPECT_EQ(row.master_weights[0].first[0], row.slave[0] + of_master);
      EXPECT_EQ(row.slave_weights.size(), 1);
      EXPECT_NEAR(row.gap, 0.1, 1e-14);
    }
}

// Concentric cylinders of radii 1 and 1.1 with different meshes: rows point outward, gaps are those between the chords.
TEST(SurfaceMortar, curved_sides)
{
  const auto cylinder = [](const double radius) {
    return
      [=](const double s, const double t) { return Point(radius * std::cos(1.2 * s), radius * std::sin(1.2 * s), t); };
  };
  const auto slave  = surface(12, 2, cylinder(1), false, 0);
  const auto master = surface(17, 3, cylinder(1.1), true, of_master);
  double     area   = 0;
  for (const auto &row : rows(slave, master))
    {
      const Tensor radial({row.position[0], row.position[1], 0.});
      EXPECT_GT(row.normal * radial / radial.norm(), std::cos(0.06));
      EXPECT_NEAR(row.gap, 0.1, 1.1 * 0.1 * 0.1 / 8);
      area += row.measure;
    }
  EXPECT_NEAR(area, 12 * 2 * std::sin(0.05), 1e-2 * 1.2);
}

TEST(SurfaceMortar, facing_distance)
{
  const auto slave = surface(3, 3, rectangle(0, 1, 0, 1, 0), true, 0);
  const auto below = surface(4, 4, rectangle(0, 1, 0, 1, -0.3), false, of_master);
  EXPECT_NEAR(*interface::facing_distance(slave, below), 0.3, 1e-14);
  const auto aside = surface(4, 4, rectangle(1.4, 2, 0, 1, -0.3), false, of_master);
  EXPECT_NEAR(*interface::facing_distance(slave, aside), 0.5, 1e-14);
  EXPECT_FALSE(interface::facing_distance(slave, aside, 0.4));
  EXPECT_FALSE(interface::facing_distance(slave, surface(4, 4, rectangle(0, 1, 0, 1, -0.3), true, of_master)));
}

// Quadrilaterals and triangles, matching and not, with gaps from a hundredth to five of their cells, plane and bent.
TEST(SurfaceMortar, rows_across_gaps_resist_no_rotation)
{
  for (const double gap : {0.002, 0.1, 0.9})
    for (const double bend : {0., 0.2})
      for (const unsigned int n : {5, 4})
        for (const bool is_split : {false, true})
          {
            const auto place = [&](const double z) {
              return [=](const double s, const double t) { return Point(s, t, z + bend * (s - 0.5) * (s - t)); };
            };
            const auto slave  = surface(5, 5, place(0), true, 0, is_split);
            const auto master = surface(n, n, place(-gap), false, of_master, is_split);
            test::expect_no_resistance_to_rotations<3>(rows(slave, master, ContactDiscretization::automatic),
                                                       slave,
                                                       master,
                                                       true);
          }
}

TEST(SurfaceMortar, only_the_nearest_level_counts)
{
  for (const bool is_split : {false, true})
    for (const double step : {0.3, 0.5, 0.7})
      {
        const auto slave  = surface(4, 3, rectangle(0, 1, 0, 1, 0), true, 0, is_split);
        auto       master = surface(3, 2, rectangle(-0.2, step, -0.1, 1.1, 0), false, of_master, is_split);
        for (const auto &facet : surface(2, 5, rectangle(step, 1.2, -0.1, 1.1, -0.5), false, 2 * of_master, is_split))
          master.push_back(facet);
        const auto all = rows(slave, master);
        EXPECT_EQ(all.size(), 20u);
        for (const auto &row : all)
          EXPECT_NEAR(row.gap, row.position[0] < step + 0.25 - 1e-12 ? 0 : 0.5, 1e-12) << row.position;
      }
}
