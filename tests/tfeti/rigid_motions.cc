#include "torn.h"

#include <slipstick/base/exceptions.h>
#include <slipstick/tfeti/null_vectors.h>

using namespace slipstick;
using namespace slipstick::test;

namespace
{
  using Active = std::function<bool(const Torn &, unsigned int)>; // does the owned row take part?

  /// Free motions of the bodies of a scene.
  std::vector<tfeti::RigidMotion> motions(const Scene &scene, const Active &takes_part = {})
  {
    const Torn                                           torn(scene);
    const auto                                           session = std::make_shared<tfeti::CholmodSession>();
    std::vector<std::unique_ptr<tfeti::SubdomainSystem>> systems;
    for (unsigned int p = 0; p < torn.matrices.size(); ++p)
      {
        const auto touched = tfeti::LocalGluing::make(torn.constraints.blocks[p]).second;
        systems.push_back(std::make_unique<tfeti::SubdomainSystem>(session, torn.matrices[p], touched, false));
      }
    std::vector<bool> active;
    if (takes_part)
      for (unsigned int r = 0; r < torn.constraints.kind.size(); ++r)
        active.push_back(takes_part(torn, r));
    return tfeti::BodyMotions(systems, torn.constraints, body_names(scene), MPI_COMM_WORLD).free(active);
  }

  std::string description(const Scene &scene, const tfeti::RigidMotion &motion)
  {
    return tfeti::describe(motion, body_names(scene));
  }

  const std::vector<Cut> cuts = {whole(), blocks(3), metis(5)};

  /// Rows of the lowest node that a support holds, those of one component or of both; gluing always.
  Active one_node(const bool both_components)
  {
    return [both_components](const Torn &torn, const unsigned int row) {
      if (torn.constraints.kind[row] == tfeti::RowKind::gluing)
        return true;
      for (unsigned int p = 0; p < torn.matrices.size(); ++p)
        for (const auto &entry : torn.constraints.blocks[p])
          if (entry.row == row && node_positions(torn.spaces, p)[entry.dof / 2].norm() < 1e-9)
            return both_components || entry.dof % 2 == 0;
      return false;
    };
  }
} // namespace

TEST(RigidMotions, body_that_nothing_holds_has_three)
{
  for (const Cut &how : cuts)
    EXPECT_EQ(motions(cut(box(6), how)).size(), 3u);
}

TEST(RigidMotions, body_held_in_both_components_has_none)
{
  for (const Cut &how : cuts)
    {
      Scene scene = box(6);
      support(scene, 0, "left", "0", "0");
      EXPECT_TRUE(motions(cut(scene, how)).empty());
    }
}

TEST(RigidMotions, edge_held_in_one_component_leaves_the_translation_along_the_other)
{
  for (const Cut &how : cuts)
    {
      Scene scene = box(6);
      support(scene, 0, "left", "0", "");
      const auto found = motions(cut(scene, how));
      ASSERT_EQ(found.size(), 1u);
      const std::string text = description(scene, found[0]);
      EXPECT_TRUE(text.find("body box: translation along (0, 1)") == 0 ||
                  text.find("body box: translation along (-0, -1)") == 0 ||
                  text.find("body box: translation along (0, -1)") == 0 ||
                  text.find("body box: translation along (-0, 1)") == 0)
        << text;
      EXPECT_EQ(text.find("rotation"), std::string::npos) << text;
      EXPECT_LT(std::abs(found[0].amplitudes[0]) + std::abs(found[0].amplitudes[2]), 1e-9);
    }
}

TEST(RigidMotions, two_edges_held_in_one_component_each_leave_none)
{
  for (const Cut &how : cuts)
    {
      Scene scene = box(6);
      support(scene, 0, "left", "0", "");
      support(scene, 0, "bottom", "", "0");
      EXPECT_TRUE(motions(cut(scene, how)).empty());
    }
}

TEST(RigidMotions, body_held_at_a_node_turns_about_it)
{
  for (const Cut &how : cuts)
    {
      Scene scene = box(6);
      support(scene, 0, "left", "0", "0");
      const auto found = motions(cut(scene, how), one_node(true));
      ASSERT_EQ(found.size(), 1u);
      // about the corner (0, 0), by amplitudes about the centre (5, 5) with unit of length sqrt(50)
      const Eigen::Vector3d a      = found[0].amplitudes / found[0].amplitudes[2];
      const double          expect = 5 / std::sqrt(50.);
      EXPECT_NEAR(a[0], -expect, 1e-9);
      EXPECT_NEAR(a[1], expect, 1e-9);
      EXPECT_EQ(description(scene, found[0]), "body box: rotation about (0, 0)");
    }
}

TEST(RigidMotions, body_held_at_a_node_in_one_component_has_two)
{
  for (const Cut &how : cuts)
    {
      Scene scene = box(6);
      support(scene, 0, "left", "0", "0");
      EXPECT_EQ(motions(cut(scene, how), one_node(false)).size(), 2u);
    }
}

TEST(RigidMotions, floating_body_beside_a_held_one_is_named_alone)
{
  for (const Cut &how : {whole(), blocks(2), metis(6)})
    {
      Scene scene = box(6);
      add_body(scene, "float", {20, 20}, {3, 5}, {{4, 4}});
      support(scene, 0, "left", "0", "0");
      const auto found = motions(cut(scene, how));
      ASSERT_EQ(found.size(), 3u);
      for (const auto &motion : found)
        {
          const std::string text = description(scene, motion);
          EXPECT_NE(text.find("body float: "), std::string::npos) << text;
          EXPECT_EQ(text.find("body box"), std::string::npos) << text;
        }
    }
}

TEST(RigidMotions, box_without_friction_on_a_circle_turns_about_its_centre)
{
  for (const Cut &how : cuts)
    {
      Scene scene = box(6);
      touch(scene, 0, "bottom", {4, -20}, 20, "");
      const auto found = motions(cut(scene, how));
      ASSERT_EQ(found.size(), 1u);
      const Eigen::Vector3d a =
        found[0].amplitudes / found[0].amplitudes[2] * std::sqrt(50.); // motion of the point (5, 5)
      EXPECT_NEAR(a[0], -25, 1e-6);
      EXPECT_NEAR(a[1], 1, 1e-6);
    }
}

TEST(RigidMotions, friction_holds_the_box_on_the_circle)
{
  for (const Cut &how : cuts)
    {
      Scene scene = box(6);
      touch(scene, 0, "bottom", {4, -20}, 20, "1");
      EXPECT_TRUE(motions(cut(scene, how)).empty());
    }
}

TEST(RigidMotions, plainest_motion_is_that_of_one_component_or_that_of_the_loads)
{
  for (const Cut &how : cuts)
    {
      Scene scene = box(6);
      EXPECT_EQ(description(scene, tfeti::plainest(motions(cut(scene, how)))), "body box: translation along (1, 0)");
      load(scene, 0, "top", "3", "-4");
      const auto pushed = tfeti::plainest(motions(cut(scene, how)));
      EXPECT_GT(pushed.work, 0.1);
      // 30 and -40 N at the middle of the top, 5 mm off the centre; unit of length sqrt(50) mm
      const Eigen::Vector3d along = Eigen::Vector3d(30, -40, -150 / std::sqrt(50.)).normalized();
      EXPECT_LT((pushed.amplitudes - along).norm(), 1e-9);
    }
}

TEST(RigidMotions, unit_of_length_does_not_matter)
{
  for (const double unit : {1e-6, 1., 1e6})
    {
      Scene scene;
      add_body(scene, "box", {3 * unit, -unit}, {10 * unit, 10 * unit}, {{6, 6}});
      touch(scene, 0, "bottom", {8 * unit, -21 * unit}, 20 * unit, "");
      EXPECT_EQ(motions(cut(scene, blocks(2))).size(), 1u) << unit;
    }
}

TEST(RigidMotions, work_of_the_loads_is_that_along_the_motion)
{
  for (const Cut &how : cuts)
    {
      Scene scene = box(6);
      support(scene, 0, "left", "0", "");
      load(scene, 0, "top", "0", "-7");
      const auto along = motions(cut(scene, how));
      ASSERT_EQ(along.size(), 1u);
      EXPECT_NEAR(std::abs(along[0].work), 1, 1e-9);
      scene.tractions.clear();
      load(scene, 0, "left", "3", "0");
      const auto across = motions(cut(scene, how));
      ASSERT_EQ(across.size(), 1u);
      EXPECT_NEAR(across[0].work, 0, 1e-9);
    }
}

TEST(RigidMotions, dual_problem_refuses_a_free_body_on_all_ranks)
{
  for (const Cut &how : {whole(), blocks(2), metis(6)})
    {
      Scene scene = box(6);
      add_body(scene, "float", {20, 20}, {3, 5}, {{4, 4}});
      support(scene, 0, "left", "0", "0");
      support(scene, 1, "top", "", "0");
      const std::string text = message_on_all_ranks<NoEquilibrium>([&] { Torn(cut(scene, how)).dual(); });
      EXPECT_NE(text.find("nothing holds body float: translation along ("), std::string::npos) << text;
      EXPECT_NE(text.find("remedy: "), std::string::npos) << text;
    }
}

namespace
{
  /// Two chains of springs of unit stiffness, n points each; the first point of the first one is held by @p hold.
  Eigen::SparseMatrix<double> two_chains(const unsigned int n, const double hold)
  {
    std::vector<Eigen::Triplet<double>> entries{{0, 0, hold}};
    for (unsigned int i = 0; i + 1 < 2 * n; ++i)
      if (i + 1 != n)
        for (const auto &[row, column, value] :
             {std::tuple(i, i, 1.), {i + 1, i + 1, 1.}, {i, i + 1, -1.}, {i + 1, i, -1.}})
          entries.emplace_back(row, column, value);
    Eigen::SparseMatrix<double> result(2 * n, 2 * n);
    result.setFromTriplets(entries.begin(), entries.end());
    return result;
  }
} // namespace

TEST(NullVectors, lie_on_the_parts_that_are_loose)
{
  constexpr unsigned int n = 40;
  EXPECT_NEAR(tfeti::largest_eigenvalue(two_chains(n, 0)), 4, 0.3); // 4 sin^2(pi (n-1) / 2n)
  for (const double hold : {0., 1.})
    {
      const auto found = tfeti::null_vectors(two_chains(n, hold), 1e-10);
      ASSERT_EQ(found.size(), hold > 0 ? 1u : 2u);
      const Eigen::VectorXd &last = found.back();
      EXPECT_LT(last.head(n).norm(), 1e-12);
      EXPECT_LT((last.tail(n).array() - last[n]).abs().maxCoeff(), 1e-9);
      EXPECT_NEAR(last.norm(), 1, 1e-12);
    }
  const double weakest = 4 * std::pow(std::sin(M_PI / (2 * (2 * n + 1))), 2); // of the chain that is held
  auto         held    = two_chains(n, 1);
  held.coeffRef(n, n) += 1;
  EXPECT_TRUE(tfeti::null_vectors(held, 0.99 * weakest).empty());
  EXPECT_EQ(tfeti::null_vectors(held, 1.01 * weakest).size(), 2u);
}
