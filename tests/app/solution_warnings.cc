// What answers are warned of: each warning where it is due, none where it is not.
#include "solved.h"

#include <slipstick/app/solution_warnings.h>

using namespace slipstick;
using namespace slipstick::test;

namespace
{
  std::map<std::string, std::string> warnings(const Scene &scene)
  {
    const Solved solved(scene);
    EXPECT_EQ(solved.solution.status, qp::Status::converged);
    const auto recovery = tfeti::recover(*solved.dual, solved.solution.multipliers, solved.solution.free);
    const auto checked  = contact::check(*solved.dual,
                                        contact::SlipLaw(solved.solution.slip_bound),
                                        recovery.multipliers,
                                        recovery.u,
                                        solved.solution.slip_bound,
                                        solved.solution.free,
                                        scene.bodies.size());
    return app::solution_warnings(scene,
                                  solved.torn.mesh,
                                  solved.torn.spaces,
                                  *solved.dual,
                                  recovery.multipliers,
                                  solved.solution.free,
                                  checked.nodes,
                                  recovery.u);
  }

  Scene pressed_box(const double modulus)
  {
    Scene scene                      = cut(box_on_circle(8, "100"), blocks(2));
    scene.materials[0].young_modulus = modulus;
    scene.solver.tolerance           = 1e-12; // stiff bodies: gaps are far above displacements
    return scene;
  }

  /// Two blocks, the upper one moved sideways by @p slip on the lower one [mm].
  Scene sliding_blocks(const double slip)
  {
    Scene scene = cut({}, metis(4));
    add_body(scene, "lower", {0, 0}, {10, 10}, {{8, 8}});
    add_body(scene, "upper", {0, 10}, {10, 10}, {{8, 8}});
    support(scene, 0, "bottom", "0", "0");
    support(scene, 1, "top", std::to_string(slip), "-0.01");
    touch(scene, {1, "bottom"}, {0, "top"}, scene::make_law<2>("Tresca", {"1"}));
    return scene;
  }

  std::string keys(const Scene &scene)
  {
    std::string all;
    for (const auto &[key, text] : warnings(scene))
      all += (all.empty() ? "" : ", ") + key;
    return all;
  }
} // namespace

TEST(AnswerWarnings, none_of_a_sound_answer)
{
  EXPECT_EQ(keys(pressed_box(1e5)), "");
  EXPECT_EQ(keys(sliding_blocks(0.5)), "");
}

TEST(AnswerWarnings, of_a_slip_by_more_than_an_edge)
{
  const auto found = warnings(sliding_blocks(2)); // an edge is 1.25 mm
  ASSERT_EQ(found.size(), 1u);
  const std::string &text = found.at("slip pair");
  EXPECT_NE(text.find("Contact pair: its sides slide by "), std::string::npos) << text;
  EXPECT_NE(text.find("more than an edge of 1.25 mm"), std::string::npos) << text;
}

TEST(AnswerWarnings, of_an_overlap_by_more_than_an_edge)
{
  Scene scene               = pressed_box(1e5);
  scene.obstacles[0].radius = 22;
  const auto found          = warnings(scene);
  ASSERT_EQ(found.count("overlap touches"), 1u) << keys(scene);
  EXPECT_NE(found.at("overlap touches").find("overlap by 2 mm at (5, 0)"), std::string::npos)
    << found.at("overlap touches");
}

TEST(AnswerWarnings, of_moduli_far_too_small_and_far_too_large)
{
  const auto soft = warnings(pressed_box(100)); // the load is 250 MPa
  for (const char *key : {"pressure touches", "strain", "rotation", "motion"})
    EXPECT_EQ(soft.count(key), 1u) << key;
  EXPECT_EQ(keys(pressed_box(1e12)), "moduli"); // as if in Pa
  EXPECT_EQ(keys(pressed_box(1e6)), "");
}
