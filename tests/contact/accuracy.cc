// The algebraic error of iterates in the energy norm, and solves that end when it is small enough.
#include "solved.h"

#include <slipstick/contact/checks.h>

using namespace slipstick;
using namespace slipstick::test;

namespace
{
  enum class Kind
  {
    linear,
    tresca,
    coulomb
  };

  Scene pressed_box(const Kind kind, const scene::Algorithm algorithm, const Cut &how)
  {
    Scene scene = cut(kind == Kind::linear ? box(12) : box_on_circle(12, kind == Kind::tresca ? "60" : ""), how);
    if (kind == Kind::linear)
      {
        support(scene, 0, "left", "0", "0");
        load(scene, 0, "right", "40", "-30");
      }
    if (kind == Kind::coulomb)
      scene.contacts[0].law = scene::make_law<2>("Coulomb", {"0.3"});
    scene.solver.algorithm                     = algorithm;
    scene.solver.tolerance                     = 1e-10;
    scene.solver.stops_at_discretization_error = true; // SMALBE keeps the preconditioner for the error, too
    scene.solver.dual.preconditioner_precision = tfeti::Precision::double_precision;
    return scene;
  }

  /// A soft block pressed on a stiff one, both cut into subdomains.
  Scene soft_on_stiff()
  {
    Scene scene = cut({}, metis(6));
    add_body(scene, "stiff", {0, 0}, {10, 4}, {{10, 4}});
    add_body(scene, "soft", {2, 4}, {6, 3}, {{7, 3}});
    scene.materials[0].young_modulus = 1e9;
    scene.materials[1].young_modulus = 1e3;
    support(scene, 0, "bottom", "0", "0");
    support(scene, 1, "top", "0", "-0.1 - 0.02*x");
    touch(scene, {1, "bottom"}, {0, "top"}, {});
    scene.solver.algorithm                     = scene::Algorithm::semismooth_newton;
    scene.solver.tolerance                     = 1e-12;
    scene.solver.dual.preconditioner_precision = tfeti::Precision::double_precision;
    return scene;
  }

  /// u'K u of every body.
  Eigen::VectorXd energies(const tfeti::DualProblem &dual, const std::vector<Eigen::VectorXd> &u)
  {
    Eigen::VectorXd sums = Eigen::VectorXd::Zero(dual.body_motions().names().size());
    for (unsigned int p = 0; p < u.size(); ++p)
      sums[dual.subdomains()[p]->body()] += u[p].dot(dual.subdomains()[p]->apply_stiffness(u[p]));
    MPI_Allreduce(MPI_IN_PLACE, sums.data(), sums.size(), MPI_DOUBLE, MPI_SUM, dual.communicator());
    return sums;
  }

  double energy(const tfeti::DualProblem &dual, const std::vector<Eigen::VectorXd> &u)
  {
    return energies(dual, u).sum();
  }

  struct Problem
  {
    explicit Problem(const Scene &scene_)
      : scene(scene_)
      , options(contact::resolved_options(scene))
    {
      scene.solver = options;
      torn         = std::make_unique<Torn>(scene, MPI_COMM_WORLD);
      dual         = torn->dual();
    }

    contact::DualSolution solve(const contact::AccuracyTest &is_accurate) const
    {
      return contact::solve(*dual,
                            contact::SlipLaw(scene, *dual, 1.),
                            options,
                            scene.friction,
                            {},
                            nullptr,
                            is_accurate);
    }

    contact::Checks checks(const contact::DualSolution &iterate) const
    {
      const auto recovery = tfeti::recover(*dual, iterate.multipliers, iterate.free);
      return contact::check(*dual,
                            contact::SlipLaw(iterate.slip_bound),
                            recovery.multipliers,
                            recovery.u,
                            iterate.slip_bound,
                            iterate.free,
                            dual->body_motions().names().size())
        .checks;
    }

    /// Estimate of the algebraic error.
    double error(const contact::DualSolution &iterate) const
    {
      return std::sqrt(checks(iterate).error_energy);
    }

    std::vector<Eigen::VectorXd> recovered(const contact::DualSolution &solution) const
    {
      return tfeti::recover(*dual, solution.multipliers, solution.free).u;
    }

    Scene                               scene;
    scene::SolverOptions                options;
    std::unique_ptr<Torn>               torn;
    std::unique_ptr<tfeti::DualProblem> dual;
  };

  std::vector<Eigen::VectorXd> difference(const std::vector<Eigen::VectorXd> &a, const std::vector<Eigen::VectorXd> &b)
  {
    std::vector<Eigen::VectorXd> result;
    for (unsigned int p = 0; p < a.size(); ++p)
      result.push_back(a[p] - b[p]);
    return result;
  }

  const std::vector<std::pair<Kind, scene::Algorithm>> solvers = {{Kind::linear, scene::Algorithm::pcg},
                                                                  {Kind::tresca, scene::Algorithm::semismooth_newton},
                                                                  {Kind::tresca, scene::Algorithm::smalbe},
                                                                  {Kind::coulomb, scene::Algorithm::semismooth_newton}};
} // namespace

TEST(AlgebraicError, is_estimated_from_above_and_not_by_far)
{
  for (const auto &[kind, algorithm] : solvers)
    for (const Cut &how : {blocks(3), metis(5)})
      {
        SCOPED_TRACE("kind " + std::to_string(int(kind)) + ", algorithm " + std::to_string(int(algorithm)) + ", cut " +
                     std::to_string(how.n));
        const Problem problem(pressed_box(kind, algorithm, how));
        const auto    exact = problem.recovered(problem.solve({}));
        const double  total = energy(*problem.dual, exact);
        unsigned int  n     = 0;
        double        sum   = 0;
        problem.solve([&](const contact::DualSolution &iterate, const double) {
          const double true_error = std::sqrt(energy(*problem.dual, difference(problem.recovered(iterate), exact)));
          const double estimate   = problem.error(iterate);
          if (true_error > 1e-6 * std::sqrt(total))
            {
              EXPECT_LT(true_error, 1.02 * estimate);
              EXPECT_LT(estimate, 20 * true_error);
              sum += std::log(estimate / true_error);
              ++n;
            }
          return false;
        });
        EXPECT_GT(n, 2u);
        EXPECT_LT(std::exp(sum / n), 4) << "mean effectivity";
      }
}

TEST(AlgebraicError, of_a_stiff_body_among_soft_ones_is_seen)
{
  const Problem problem(soft_on_stiff());
  const auto    exact = problem.recovered(problem.solve({}));
  const auto    total = energies(*problem.dual, exact);
  EXPECT_LT(total[0], 1e-3 * total[1]);
  unsigned int n = 0, n_hidden = 0;
  problem.solve([&](const contact::DualSolution &iterate, const double) {
    const auto   checks = problem.checks(iterate);
    const auto   errors = energies(*problem.dual, difference(problem.recovered(iterate), exact));
    const double worst  = (errors.array() / total.array()).sqrt().maxCoeff();
    if (worst > 1e-6 && worst < 0.5)
      {
        EXPECT_LT(worst, 2 * checks.body_error);
        EXPECT_LT(checks.body_error, 20 * worst);
        n_hidden += checks.body_error > 10 * checks.algebraic_error;
        ++n;
      }
    return false;
  });
  EXPECT_GT(n, 2u);
  EXPECT_GT(n_hidden, 0u);
}

TEST(AlgebraicError, ends_a_solve_as_soon_as_it_is_small_enough)
{
  for (const auto &[kind, algorithm] : solvers)
    {
      SCOPED_TRACE("kind " + std::to_string(int(kind)) + ", algorithm " + std::to_string(int(algorithm)));
      const Problem problem(pressed_box(kind, algorithm, blocks(3)));
      const auto    fine   = problem.solve({});
      const auto    exact  = problem.recovered(fine);
      const double  limit  = 0.01 * std::sqrt(energy(*problem.dual, exact));
      const auto    coarse = problem.solve(
        [&](const contact::DualSolution &iterate, const double) { return problem.error(iterate) <= limit; });
      EXPECT_EQ(coarse.status, qp::Status::converged);
      EXPECT_LE(std::sqrt(energy(*problem.dual, difference(problem.recovered(coarse), exact))), 1.02 * limit);
      EXPECT_LT(coarse.counts.hessian_multiplications, 0.7 * fine.counts.hessian_multiplications);
      EXPECT_EQ(coarse.fallbacks, 0u);
    }
}

TEST(TractionErrors, are_relative_to_pressures_and_to_tangential_tractions)
{
  const Problem problem(pressed_box(Kind::tresca, scene::Algorithm::semismooth_newton, blocks(3)));
  const auto   &points = problem.dual->constraints().contact_points;
  const auto    parts  = [&](auto x, const double normal, const double tangential) {
    for (const auto &point : points)
      {
        x.local_element(point.normal_row) *= normal;
        x.local_element(point.tangential_row) *= tangential;
      }
    return x;
  };
  const auto errors = [&](const auto &x, const auto &error, const double least) {
    return contact::TractionErrors(*problem.dual, x, error).relative(least).at(0);
  };
  const auto x    = problem.solve({}).multipliers;
  const auto both = errors(x, parts(x, 0.02, 0.03), 0);
  EXPECT_NEAR(both.pressure, 0.02, 1e-12);
  EXPECT_NEAR(both.tangential, 0.03, 1e-12);
  const double norm = contact::TractionErrors(*problem.dual, x, x).largest_norm();
  EXPECT_NEAR(errors(x, parts(x, 0.02, 0), 10 * norm).pressure,
              0.002 * contact::TractionErrors(*problem.dual, parts(x, 1, 0), x).largest_norm() / norm,
              1e-12);
  // without tangential tractions a fraction of the pressures is the reference
  const double ratio = contact::TractionErrors(*problem.dual, parts(x, 0, 1), x).largest_norm() /
                       contact::TractionErrors(*problem.dual, parts(x, 1, 0), x).largest_norm();
  EXPECT_NEAR(errors(parts(x, 1, 0), parts(x, 0, 1e-4), 0).tangential, 1e-2 * ratio, 1e-12);
}
