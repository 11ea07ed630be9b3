#include "torn.h"

#include <slipstick/base/exceptions.h>

using namespace slipstick;
using namespace slipstick::test;

namespace
{
  /// Force and moment about the origin of all loads of a scene, all ranks.
  std::array<double, 3> resultant(const Scene &scene, const double t = 1)
  {
    const Torn            torn(scene, MPI_COMM_WORLD, t);
    std::array<double, 3> sum{{0, 0, 0}};
    for (unsigned int p = 0; p < torn.matrices.size(); ++p)
      {
        const auto x = node_positions(torn.spaces, p);
        for (unsigned int i = 0; i < x.size(); ++i)
          {
            const double f_x = torn.matrices[p].load[2 * i], f_y = torn.matrices[p].load[2 * i + 1];
            sum[0] += f_x;
            sum[1] += f_y;
            sum[2] += x[i][0] * f_y - x[i][1] * f_x;
          }
      }
    MPI_Allreduce(MPI_IN_PLACE, sum.data(), 3, MPI_DOUBLE, MPI_SUM, MPI_COMM_WORLD);
    return sum;
  }

  void expect_resultant(const Scene &scene, const std::array<double, 3> &expect, const double t = 1)
  {
    for (const Cut &how : {whole(), blocks(3), metis(7)})
      for (const unsigned int degree : {1, 2})
        {
          Scene tested                 = cut(scene, how);
          tested.discretization.degree = degree;
          const auto found             = resultant(tested, t);
          for (const int k : {0, 1, 2})
            EXPECT_NEAR(found[k], expect[k], 1e-12 * (std::abs(expect[0]) + std::abs(expect[1]) + std::abs(expect[2])))
              << "component " << k << ", cut " << how.n << ", degree " << degree;
        }
  }
} // namespace

TEST(Loads, constant_traction)
{
  Scene scene = box(6);
  load(scene, 0, "top", "30", "-250");
  expect_resultant(scene, {{300, -2500, -2500. * 5 - 300 * 10}});
}

TEST(Loads, traction_given_as_formula)
{
  // 2 + x^2 along x, x y = 10 x along y on the top edge y = 10
  Scene scene = box(6);
  load(scene, 0, "top", "2 + x^2", "x*y");
  expect_resultant(scene, {{20 + 1000. / 3, 500, 10 * 1000. / 3 - 10 * (20 + 1000. / 3)}});
}

TEST(Loads, jumps_within_an_edge_are_integrated)
{
  Scene scene = box(6);
  load(scene, 0, "top", "0", "-20*(x>2.3 && x<7.1)");
  expect_resultant(scene, {{0, -96, -96 * 4.7}});
}

TEST(Loads, peaks_narrower_than_an_edge_are_found)
{
  const double force = 5 * std::sqrt(dealii::numbers::PI); // of 1000 exp(-((x - 4.4) / 0.005)^2)
  Scene        scene = box(6);
  load(scene, 0, "top", "0", "1000*exp(-((x-4.4)/0.005)^2)");
  expect_resultant(scene, {{0, force, force * 4.4}});
}

TEST(Loads, traction_on_every_edge)
{
  Scene scene = box(6);
  load(scene, 0, "left", "1", "0");
  load(scene, 0, "right", "0", "2*y");
  load(scene, 0, "bottom", "4*x", "0");
  load(scene, 0, "top", "0", "8");
  expect_resultant(scene, {{10 + 200, 100 + 80, -50 + 10 * 100 + 80 * 5.}});
}

TEST(Loads, tractions_on_one_edge_add_up)
{
  Scene scene = box(6);
  load(scene, 0, "right", "3", "0");
  load(scene, 0, "right", "4", "1");
  expect_resultant(scene, {{70, 10, 100 - 70 * 5.}});
}

TEST(Loads, are_proportional_to_the_thickness)
{
  Scene scene               = box(6);
  scene.bodies[0].thickness = 7;
  load(scene, 0, "top", "0", "-2");
  expect_resultant(scene, {{0, -140, -700}});
}

TEST(Loads, follow_the_load_factor)
{
  Scene scene = box(6);
  load(scene, 0, "top", "0", "-2*t^2");
  expect_resultant(scene, {{0, -5, -25}}, 0.5);
}

TEST(Loads, act_on_their_body_alone)
{
  Scene scene = box(6);
  add_body(scene, "other", {20, 0}, {10, 10}, {{6, 6}});
  load(scene, 1, "top", "0", "-2");
  for (const Cut &how : {whole(), blocks(3), metis(8)})
    for (const auto &system : Torn(cut(scene, how)).matrices)
      if (system.body == 0)
        {
          EXPECT_EQ(system.load.norm(), 0);
        }
  expect_resultant(scene, {{0, -20, -20 * 25.}});
}
