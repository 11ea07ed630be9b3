// Adjoint problems: derivatives of quantities with respect to the gaps, against differences of solutions.
#include "torn.h"

#include <slipstick/contact/adjoint.h>
#include <slipstick/contact/friction.h>

#include <deal.II/base/mpi.h>

using namespace slipstick;
using namespace slipstick::test;

namespace
{
  /// A box on a circle with Coulomb friction; nodes slip at one end of the contact and stick at the other.
  struct WithFriction
  {
    explicit WithFriction(const Cut &how)
      : scene(cut(uncut(), how))
      , torn(scene)
      , dual(torn.dual(contact::resolved_options(scene).dual))
      , law(scene, *dual, 1.)
    {}

    static Scene uncut()
    {
      Scene scene = box(16);
      support(scene, 0, "left", "0", "0");
      load(scene, 0, "top", "0", "-250");
      touch(scene, 0, "bottom", {5, -400}, 400, "0");
      scene.contacts[0].law  = scene::make_law<2>("Coulomb", {"0.25"});
      scene.solver.tolerance = 1e-12;
      return scene;
    }

    contact::DualSolution solve() const
    {
      return contact::solve(*dual, law, contact::resolved_options(scene), scene.friction, {});
    }

    /// Gradients of the normal and the tangential force on the pair.
    std::vector<std::vector<double>> gradients() const
    {
      std::vector<std::vector<double>> g(2, std::vector<double>(torn.constraints.kind.size(), 0.));
      for (const auto &point : torn.constraints.contact_points)
        g[0][point.normal_row] = g[1][point.tangential_row] = 1;
      return g;
    }

    double sum(const std::vector<double> &g, const tfeti::DistributedVector &x) const
    {
      double own = 0;
      for (unsigned int r = 0; r < g.size(); ++r)
        own += g[r] * x.local_element(r);
      return dealii::Utilities::MPI::sum(own, dual->communicator());
    }

    Scene                               scene;
    Torn                                torn;
    std::unique_ptr<tfeti::DualProblem> dual;
    contact::SlipLaw                    law;
  };
} // namespace

TEST(Adjoint, friction_follows_the_pressure_in_derivatives_with_respect_to_gaps)
{
  for (const Cut &how : {whole(), blocks(2), metis(5)})
    {
      const WithFriction  problem(how);
      auto               &dual     = *problem.dual;
      const auto          solution = problem.solve();
      const auto          ties     = contact::following_friction(problem.law, solution);
      const auto          c        = problem.torn.constraints.c;
      std::vector<double> change(c.size(), 0.); // of the gaps
      unsigned int        n_stick = 0;
      for (const auto &point : problem.torn.constraints.contact_points)
        {
          change[point.normal_row] = 1e-7 * (1 + 0.3 * point.position[0]);
          n_stick += solution.free[point.tangential_row] ? 1 : 0;
        }
      EXPECT_GE(dealii::Utilities::MPI::sum(static_cast<unsigned int>(ties.size()), dual.communicator()), 2u);
      EXPECT_GE(dealii::Utilities::MPI::sum(n_stick, dual.communicator()), 1u);

      std::vector<tfeti::DistributedVector> with_change;
      for (const double sign : {1., -1.})
        {
          auto moved = c;
          for (unsigned int r = 0; r < c.size(); ++r)
            moved[r] += sign * change[r];
          dual.set_right_hand_side(moved);
          with_change.push_back(problem.solve().multipliers);
        }
      dual.set_right_hand_side(c);

      contact::Adjoint with_ties(dual, solution.free, ties), without(dual, solution.free);
      double           with_fixed_bounds = 0; // largest relative error
      for (const auto &g : problem.gradients())
        {
          const double difference = (problem.sum(g, with_change[0]) - problem.sum(g, with_change[1])) / 2;
          const auto   z = with_ties.solve(g), fixed = without.solve(g);
          ASSERT_TRUE(z && fixed);
          EXPECT_NEAR(problem.sum(change, z->multipliers), difference, 0.02 * std::abs(difference));
          with_fixed_bounds =
            std::max(with_fixed_bounds, std::abs(problem.sum(change, fixed->multipliers) / difference - 1));
        }
      EXPECT_GT(with_fixed_bounds, 0.1);
    }
}
