// Two bodies pressed on each other through meshes that do not match.
#include "solved.h"

#include <slipstick/base/exceptions.h>
#include <slipstick/interface/body_contact.h>

using namespace slipstick;
using namespace slipstick::test;

namespace
{
  /// Lower block [0, 10] x [0, 4] on rollers, upper block on it, pressed; both slide freely sideways.
  Scene two_blocks(const std::array<unsigned int, 2> &lower,
                   const std::array<unsigned int, 2> &upper,
                   const unsigned int                 degree,
                   const double                       poisson_ratio,
                   const std::string                 &law)
  {
    Scene scene                 = cut(Scene(), whole());
    scene.discretization.degree = degree;
    add_body(scene, "lower", {0, 0}, {10, 4}, lower);
    add_body(scene, "upper", {0, 4}, {10, 3}, upper);
    for (auto &material : scene.materials)
      material.poisson_ratio = poisson_ratio;
    support(scene, 0, "bottom", "", "0");
    support(scene, 0, "left", "0", "");
    support(scene, 1, "left", "0", "");
    load(scene, 1, "top", "0", "-100");
    touch(scene, {1, "bottom"}, {0, "top"}, scene::make_law<2>(law));
    scene.solver.tolerance = 1e-12;
    return scene;
  }

  /// Largest error of the displacement of a uniform stress -p along y, relative.
  double error_of_uniform_stress(const Solved &solved, const double poisson_ratio)
  {
    const double E = 1e5, p = 100;
    double       error = 0, largest = 0;
    for (const auto &[x, y, u, v] : nodal_field(solved.torn, solved.u))
      {
        error   = std::max({error, std::abs(u - poisson_ratio * p / E * x), std::abs(v + p / E * y)});
        largest = std::max(largest, p / E * y);
      }
    return error / largest;
  }
} // namespace

TEST(ContactPatch, uniform_pressure_passes_meshes_that_do_not_match)
{
  for (const unsigned int degree : {1, 2})
    for (const double poisson_ratio : {0., 0.3})
      for (const auto law : {"frictionless", "bonded"})
        for (const Cut &how : {whole(), metis(5)})
          {
            SCOPED_TRACE(std::to_string(degree) + " " + std::to_string(poisson_ratio) + " " + std::to_string(how.n));
            const Solved solved(cut(two_blocks({{5, 2}}, {{7, 3}}, degree, poisson_ratio, law), how));
            EXPECT_EQ(solved.solution.status, qp::Status::converged);
            EXPECT_LT(error_of_uniform_stress(solved, poisson_ratio), 1e-10);
          }
}

TEST(ContactPatch, matching_meshes_have_node_to_node_rows)
{
  for (const unsigned int degree : {1, 2})
    {
      const Torn torn(two_blocks({{5, 2}}, {{5, 2}}, degree, 0.3, "frictionless"));
      for (const auto &rows : interface::pair_bodies(torn.scene, torn.mesh, torn.spaces).rows)
        for (const auto &row : rows)
          EXPECT_EQ(row.master_weights.size(), 1u);
    }
}

TEST(ContactPatch, pairs_out_of_reach_and_back_to_back_are_refused_on_all_ranks)
{
  Scene scene             = two_blocks({{5, 2}}, {{7, 3}}, 1, 0.3, "frictionless");
  scene.bodies[1].origin  = {0, 5};
  scene.contacts[0].reach = 0.5;
  const std::string far   = message_on_all_ranks<InputError>([&] { Torn torn(scene); });
  for (const std::string part : {"Contact pair", "upper/bottom", "lower/top", "0.5", "1 mm apart", "Reach"})
    EXPECT_NE(far.find(part), std::string::npos) << far;
  scene.contacts[0].master->boundary = "bottom";
  const std::string back             = message_on_all_ranks<InputError>([&] { Torn torn(scene); });
  EXPECT_NE(back.find("face each other"), std::string::npos) << back;
}
