// Differences between the gaps interpolated from the nodes and the gaps between the surfaces.
#include "torn.h"

#include <slipstick/interface/gap_defect.h>

using namespace slipstick;
using namespace slipstick::test;

namespace
{
  struct GapDefect
  {
    /// Mean of the interpolated gap minus the gap, weighted with the hat function of a node at distance @p at from the
    /// place of the smallest gap, for a circle or ball beside a plane, by the midpoint rule.
    static double between(const double at, const double h, const double radius)
    {
      constexpr unsigned int n   = 2000;
      const auto             gap = [&](const double x) { return std::hypot(x, radius) - radius; };
      double                 sum = 0;
      for (unsigned int k = 0; k < 2 * n; ++k)
        {
          const double s  = (k + .5) / n - 1; // from node to node
          const int    to = s < 0 ? -1 : 1;
          sum +=
            (1 - std::abs(s)) * ((1 - std::abs(s)) * gap(at) + std::abs(s) * gap(at + to * h) - gap(at + s * h)) / n;
        }
      return sum;
    }
  };
} // namespace

TEST(GapDefect, of_a_circle_is_what_the_polygon_through_its_gaps_adds)
{
  for (const unsigned int degree : {1, 2})
    {
      const unsigned int n = 16;
      const Torn         torn(cut(box_on_circle(n, "", degree), metis(3)));
      const auto         defects = interface::gap_defects(torn.scene, torn.mesh, torn.spaces, 1);
      ASSERT_EQ(defects.of_pairs.size(), 1u);
      EXPECT_EQ(defects.of_pairs[0].size(), degree * n + 1);
      for (const auto &point : torn.constraints.contact_points)
        {
          const double x = point.position[0], found = defects.of_pairs[0].at(point.key);
          if (x < .1 || x > 9.9)
            {
              EXPECT_EQ(defects.n_parts[0].at(point.key), 1u);
            }
          else if (degree == 1)
            {
              EXPECT_NEAR(found, GapDefect::between(x - 5, 10. / n, 20), 1e-3 * 10. / n * 10. / n / 240);
              EXPECT_EQ(defects.n_parts[0].at(point.key), 2u);
            }
          else
            EXPECT_LT(std::abs(found), 1e-2 * 10. / n * 10. / n / 240);
        }
    }
}

TEST(GapDefect, is_of_pairs_node_to_node_alone)
{
  constexpr unsigned int n = 64;
  for (const bool is_round : {true, false}) // the hole
    for (const auto how : {scene::ContactDiscretization::automatic, scene::ContactDiscretization::mortar})
      {
        Scene scene;
        scene.materials.emplace_back();
        for (const char *name : {"disc", "ring"})
          {
            scene.bodies.emplace_back();
            scene.bodies.back().name = name;
          }
        scene.bodies[0].shape              = scene::Shape::ring;
        scene.bodies[0].inner_radius       = 8;
        scene.bodies[0].radius             = 10;
        scene.bodies[0].cells              = std::array<unsigned int, 2>{{n, 2}};
        scene.bodies[1].shape              = scene::Shape::ring;
        scene.bodies[1].inner_radius       = 10.01;
        scene.bodies[1].radius             = 12;
        scene.bodies[1].cells              = std::array<unsigned int, 2>{{n, 2}};
        scene.bodies[1].has_smooth_outline = is_round;
        touch(scene, {0, "outer"}, {1, "inner"}, {});
        scene.contacts[0].discretization = how;
        scene.decomposition.subdomains   = 4;
        const auto   mesh                = mesh::make_mesh(scene, MPI_COMM_WORLD);
        const auto   defects = interface::gap_defects(scene, mesh, mechanics::Spaces<2>(mesh, 1), 1).of_pairs[0];
        const double sagitta = 10.01 * (1 - std::cos(M_PI / n));
        ASSERT_EQ(defects.size(), n);
        for (const auto &entry : defects)
          EXPECT_NEAR(entry.second,
                      how == scene::ContactDiscretization::automatic && !is_round ? 2. / 3 * sagitta : 0.,
                      0.01 * sagitta);
      }
}

TEST(GapDefect, in_space_is_that_of_both_directions)
{
  for (const bool in_tetrahedra : {false, true})
    {
      scene::Scene<3> scene;
      scene.materials.emplace_back();
      scene.bodies.emplace_back();
      scene.bodies[0].name = "cube";
      scene.bodies[0].size = {10, 10, 10};
      scene.bodies[0].cells.emplace();
      *scene.bodies[0].cells = {{10, 2, 10}};
      scene.obstacles.emplace_back();
      scene.obstacles[0].shape  = scene::ObstacleShape::circle;
      scene.obstacles[0].center = {5, -1000, 5};
      scene.obstacles[0].radius = 1000;
      scene.contacts.emplace_back();
      scene.contacts[0].slave        = {0, "bottom"};
      scene.contacts[0].obstacle     = 0;
      scene.decomposition.method     = scene::DecompositionMethod::metis;
      scene.decomposition.subdomains = 3;
      mesh::Refinement refinement;
      const auto       mesh    = mesh::make_mesh(scene, MPI_COMM_WORLD, in_tetrahedra ? &refinement : nullptr);
      const auto       defects = interface::gap_defects(scene, mesh, mechanics::Spaces<3>(mesh, 1), 1).of_pairs[0];
      ASSERT_EQ(defects.size(), 121u);
      unsigned int n_inside = 0;
      for (const auto &entry : defects)
        n_inside += std::abs(entry.second - 1. / 6000) < 1e-3 / 6000; // for squares and triangles alike
      EXPECT_GE(n_inside, 81u);
    }
}
