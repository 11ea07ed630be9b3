#include "torn.h"

#include <slipstick/base/exceptions.h>
#include <slipstick/contact/checks.h>
#include <slipstick/contact/friction.h>

using namespace slipstick;
using namespace slipstick::test;

namespace
{
  constexpr double size = 10, pressure = 20; // [mm], [MPa]

  /// A block on a plane, with the shear stress tau [MPa] at its sides.
  Scene block(const scene::ContactLaw<2> &law, const double tau, const Cut &how)
  {
    Scene scene = cut(box(4), how);
    for (auto &material : scene.materials)
      material.poisson_ratio = 0;
    scene::Obstacle<2> plane;
    plane.name      = "ground";
    plane.shape     = scene::ObstacleShape::half_plane;
    plane.normal[1] = 1;
    scene.obstacles.push_back(plane);
    scene::ContactPair<2> pair;
    pair.name  = "on ground";
    pair.slave = {0, "bottom"};
    pair.law   = law;
    scene.contacts.push_back(pair);
    load(scene, 0, "right", "0", std::to_string(tau));
    load(scene, 0, "left", "0", std::to_string(-tau));
    scene.solver.tolerance = 1e-10;
    return scene;
  }

  /// Pressed and sheared by tractions: a uniform stress, which the plane must bear.
  Scene loaded_block(const scene::ContactLaw<2> &law, const double tau, const Cut &how)
  {
    Scene scene = block(law, tau, how);
    load(scene, 0, "top", std::to_string(tau), std::to_string(-pressure));
    return scene;
  }

  Scene resolved(Scene scene)
  {
    scene.solver = contact::resolved_options(scene);
    return scene;
  }

  struct Answer
  {
    explicit Answer(const Scene &scene)
      : torn(resolved(scene))
      , dual(torn.dual())
      , law(scene, *dual, 1.)
      , solution(contact::solve(*dual, law, torn.scene.solver, scene.friction, {}))
      , recovery(tfeti::recover(*dual, solution.multipliers, solution.free))
      , contact(contact::check(*dual,
                               law,
                               recovery.multipliers,
                               recovery.u,
                               law.bounds(recovery.multipliers),
                               solution.free,
                               1))
    {}

    Torn                                torn;
    std::unique_ptr<tfeti::DualProblem> dual;
    contact::SlipLaw                    law;
    contact::DualSolution               solution;
    tfeti::Recovery                     recovery;
    contact::CheckedContact             contact;
  };

  struct Numbers
  {
    std::string cohesion, coefficient, limit;
    double      bound; // of the shear stress under `pressure`

    scene::ContactLaw<2> law() const
    {
      return scene::make_law<2>("cohesion", {cohesion, coefficient, limit});
    }
  };

  const std::vector<Numbers> numbers = {{"3", "0.2", "none", 7},
                                        {"3", "0.2", "5", 5},
                                        {"3", "0.2", "2", 2},
                                        {"3", "0", "none", 3},
                                        {"0", "0.2", "3", 3}};

  const scene::Algorithm algorithms[] = {scene::Algorithm::semismooth_newton, scene::Algorithm::smalbe};

  /// Calls test(number, algorithm) for all laws and both algorithms.
  template <typename F>
  void for_each_law(const F &test)
  {
    for (const auto &number : numbers)
      for (const auto algorithm : algorithms)
        {
          SCOPED_TRACE(number.cohesion + ", " + number.coefficient + ", " + number.limit + ", algorithm " +
                       std::to_string(int(algorithm)));
          test(number, algorithm);
        }
  }

  /// Expects convergence, passed checks, and this status and shear traction everywhere under `pressure`.
  void expect_uniform(const Answer &answer, const contact::ContactStatus status, const double traction)
  {
    EXPECT_EQ(answer.solution.status, qp::Status::converged);
    EXPECT_LT(answer.contact.checks.worst().second, 1e-6);
    for (const auto &node : answer.contact.nodes)
      {
        EXPECT_EQ(node.status, status);
        EXPECT_NEAR(node.pressure, pressure, 1e-5);
        EXPECT_NEAR(node.tangential_traction, traction, 1e-5);
      }
  }
} // namespace

TEST(Cohesion, holds_a_block_up_to_its_shear_strength)
{
  for_each_law([](const Numbers &number, const scene::Algorithm algorithm) {
    const double below     = 0.99 * number.bound;
    Scene        scene     = loaded_block(number.law(), below, blocks(2));
    scene.solver.algorithm = algorithm;
    const Answer answer(scene);
    expect_uniform(answer, contact::ContactStatus::stick, -below);
    for (const auto &node : answer.contact.nodes)
      EXPECT_NEAR(node.slip_bound, number.bound, 1e-5);
  });
}

TEST(Cohesion, a_force_at_an_open_node_fails_the_checks_however_small)
{
  const double shear = 1e-4 * pressure;
  const Answer answer(loaded_block(numbers[0].law(), shear, blocks(1)));
  const auto  &points = answer.dual->constraints().contact_points;
  auto         x      = answer.recovery.multipliers;
  auto         free   = answer.solution.free;
  const auto   worst  = [&] {
    return contact::check(*answer.dual, answer.law, x, answer.recovery.u, answer.law.bounds(x), free, 1)
      .checks.friction_bound;
  };
  EXPECT_LT(worst(), 1e-6);
  const MPI_Comm     comm     = answer.dual->communicator();
  const unsigned int rank     = dealii::Utilities::MPI::this_mpi_process(comm);
  const unsigned int first    = dealii::Utilities::MPI::min(points.empty() ? 1000000u : rank, comm);
  const bool         has_node = rank == first;
  if (has_node)
    free[points.front().normal_row] = false;
  for (const double rounding : {0., 1e-14})
    {
      const double force = rounding * x.linfty_norm();
      if (has_node)
        x.local_element(points.front().normal_row) = force;
      EXPECT_GT(worst(), 0.4);
    }
  if (has_node)
    x.local_element(points.front().tangential_row) = 0;
  EXPECT_LT(worst(), 1e-6);
}

TEST(Cohesion, does_not_hold_a_block_beyond_it)
{
  for_each_law([](const Numbers &number, const scene::Algorithm algorithm) {
    Scene scene            = loaded_block(number.law(), 1.01 * number.bound, blocks(2));
    scene.solver.algorithm = algorithm;
    EXPECT_THROW(Answer{scene}, NoEquilibrium);
  });
}

TEST(Cohesion, resists_sliding_by_its_shear_strength)
{
  const double E = 1e5, top = 0.01, closing = pressure * size / E;
  for_each_law([&](const Numbers &number, const scene::Algorithm algorithm) {
    Scene scene = block(number.law(), number.bound, metis(3));
    support(scene, 0, "top", std::to_string(top), std::to_string(-closing));
    scene.solver.algorithm = algorithm;
    const Answer answer(scene);
    expect_uniform(answer, contact::ContactStatus::slip, -number.bound);
    for (const auto &node : answer.contact.nodes)
      EXPECT_NEAR(node.slip, top - number.bound * size / (E / 2), 1e-8);
  });
}

TEST(Cohesion, bears_no_tension_and_no_shear_where_it_is_open)
{
  // on a wide circle, moved sideways: closed in the middle, open at the ends, with all branches of the bound
  std::vector<Eigen::VectorXd> forces;
  for (const auto algorithm : algorithms)
    {
      Scene scene = cut(box(16), blocks(2));
      support(scene, 0, "top", "0.02", "-0.05");
      touch(scene, 0, "bottom", {5, -200}, 200, "");
      scene.contacts[0].law    = scene::make_law<2>("cohesion", {"20", "0.3", "40+40*x"});
      scene.solver.algorithm   = algorithm;
      scene.solver.tolerance   = 1e-10;
      scene.friction.tolerance = 1e-10;
      const Answer answer(scene);
      EXPECT_EQ(answer.solution.status, qp::Status::converged);
      EXPECT_LT(answer.contact.checks.worst().second, 1e-6);
      std::array<double, 4> n{{0, 0, 0, 0}}; // open, stick, slip below the limit and at it
      for (const auto &node : answer.contact.nodes)
        {
          const double limit = 40 + 40 * node.position[0], strength = std::min(20 + 0.3 * node.pressure, limit);
          EXPECT_NEAR(node.slip_bound, node.is_closed ? strength : 0., 1e-4);
          EXPECT_LE(std::abs(node.tangential_traction), node.slip_bound + 1e-4);
          EXPECT_GE(node.pressure, -1e-4);
          ++n[!node.is_closed ? 0 : node.status == contact::ContactStatus::stick ? 1 : strength < limit ? 2 : 3];
        }
      for (const double k : n)
        EXPECT_GT(dealii::Utilities::MPI::sum(k, MPI_COMM_WORLD), 0) << int(algorithm);
      forces.push_back(gathered(answer.solution.multipliers, MPI_COMM_WORLD));
    }
  EXPECT_LT((forces[0] - forces[1]).norm(), 1e-6 * forces[0].norm());
}

TEST(Cohesion, alone_is_the_law_of_tresca_or_coulomb)
{
  auto tresca           = scene::make_law<2>("Tresca", {"60"});
  tresca.acts_when_open = false;
  const std::vector<std::pair<scene::ContactLaw<2>, std::vector<std::string>>> same =
    {{scene::make_law<2>("Coulomb", {"0.3"}), {"0", "0.3", "none"}}, {tresca, {"60", "0", "none"}}};
  for (const auto &[law, numbers] : same)
    {
      Scene scene           = cut(box_on_circle(8, ""), blocks(2));
      scene.contacts[0].law = law;
      const Answer one(scene);
      scene.contacts[0].law = scene::make_law<2>("cohesion", numbers);
      const Answer other(scene);
      auto         difference = one.solution.multipliers;
      difference -= other.solution.multipliers;
      EXPECT_EQ(difference.linfty_norm(), 0.) << law.name;
      EXPECT_EQ(one.solution.counts.hessian_multiplications, other.solution.counts.hessian_multiplications) << law.name;
    }
}

TEST(ContactLaw, negative_numbers_are_refused_where_they_are)
{
  const auto law  = scene::make_law<2>("cohesion", {"1", "0.1*x", "3-x"});
  const auto text = message_on_all_ranks<InputError>([&] { law.admissible_forces(Point(5, 0), 1., 1., "joint"); });
  for (const std::string part : {"joint/Shear limit", "-2 MPa", "(5, 0)", "remedy: "})
    EXPECT_NE(text.find(part), std::string::npos) << text;
  const auto forces = law.admissible_forces(Point(2, 0), 1., 4., "joint");
  EXPECT_EQ(forces.radius(0), 0);
  EXPECT_NEAR(forces.closed_radius(0), 4., 1e-15);
  EXPECT_NEAR(forces.radius(-1), 0., 1e-15);
  EXPECT_EQ(scene::make_law<2>("cohesion", {"5", "1", "2"}).admissible_forces(Point(), 1., 3., "joint").radius(1e-9),
            6);
}
