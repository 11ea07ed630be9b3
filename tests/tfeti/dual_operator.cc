#include "torn.h"

using namespace slipstick;
using namespace slipstick::test;

namespace
{
  /// Scenes with all kinds of rows, cut in all ways; small enough for dense matrices.
  std::vector<std::pair<std::string, Scene>> scenes()
  {
    return {{"one subdomain", box_on_circle(4, "100")},
            {"blocks", cut(box_on_circle(6, "100"), blocks(3))},
            {"METIS", cut(box_on_circle(7, "100"), metis(5))},
            {"degree 2", cut(box_on_circle(4, "100", 2), metis(3))},
            {"two bodies", cut(two_bodies(4), blocks(2))}};
  }

  std::unique_ptr<tfeti::DualProblem> dual(const Torn &torn, const tfeti::DualOperatorKind kind)
  {
    tfeti::DualOptions options;
    options.dual_operator = kind;
    return torn.dual(options);
  }

  const auto both = {tfeti::DualOperatorKind::explicit_blocks, tfeti::DualOperatorKind::implicit};

  Eigen::VectorXd F_times(const tfeti::DualProblem &dual, const Eigen::VectorXd &x)
  {
    tfeti::DistributedVector y = dual.zero();
    dual.dual_operator().apply(distributed(x, dual), y);
    return gathered(y, MPI_COMM_WORLD);
  }
} // namespace

TEST(DualOperator, explicit_and_implicit_agree)
{
  for (const auto &[name, scene] : scenes())
    {
      const Torn            torn(scene);
      const Eigen::VectorXd x = random_vector(torn.constraints.rows->size(), 1);
      const auto            blockwise = dual(torn, tfeti::DualOperatorKind::explicit_blocks),
                 by_solves            = dual(torn, tfeti::DualOperatorKind::implicit);
      EXPECT_TRUE(blockwise->subdomains().empty() || blockwise->dual_operator().is_explicit());
      EXPECT_FALSE(by_solves->dual_operator().is_explicit());
      EXPECT_LT(relative_difference(F_times(*blockwise, x), F_times(*by_solves, x)), 1e-11) << name;
    }
}

TEST(DualOperator, is_symmetric)
{
  for (const auto &[name, scene] : scenes())
    for (const auto kind : both)
      {
        const Torn            torn(scene);
        const auto            problem = dual(torn, kind);
        const Eigen::VectorXd x = random_vector(torn.constraints.rows->size(), 1), y = random_vector(x.size(), 2);
        const Eigen::VectorXd Fx = F_times(*problem, x), Fy = F_times(*problem, y);
        EXPECT_LT(std::abs(y.dot(Fx) - x.dot(Fy)), 1e-12 * Fx.norm() * y.norm()) << name;
      }
}

TEST(DualOperator, is_that_of_the_assembled_system)
{
  for (const auto &[name, scene] : scenes())
    for (const auto kind : both)
      {
        const Torn            torn(scene);
        const Dense           dense(torn);
        const auto            problem = dual(torn, kind);
        const Eigen::MatrixXd P = dense.P(), PFP = dense.PFP();
        for (const unsigned int seed : {1, 2, 3})
          {
            const Eigen::VectorXd x = random_vector(P.cols(), seed);
            EXPECT_LT(relative_difference(P * F_times(*problem, P * x), PFP * x), 1e-11) << name;
          }
      }
}

TEST(DualOperator, is_positive_semidefinite)
{
  for (const auto &[name, scene] : scenes())
    for (const auto kind : both)
      {
        const Torn      torn(scene);
        const auto      problem = dual(torn, kind);
        Eigen::MatrixXd F(torn.constraints.rows->size(), torn.constraints.rows->size());
        for (int i = 0; i < F.cols(); ++i)
          F.col(i) = F_times(*problem, Eigen::VectorXd::Unit(F.rows(), i));
        const Eigen::VectorXd eigenvalues = Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(F).eigenvalues();
        EXPECT_GT(eigenvalues[0], -1e-13 * eigenvalues.tail(1)[0]) << name;
      }
}

TEST(DualOperator, applications_are_counted)
{
  const Torn torn(cut(box_on_circle(4, "100"), blocks(2)));
  const auto problem = torn.dual();
  const auto before  = problem->dual_operator().n_applications();
  F_times(*problem, Eigen::VectorXd::Zero(torn.constraints.rows->size()));
  EXPECT_EQ(problem->dual_operator().n_applications(), before + 1);
}

TEST(DualOperator, source_and_target_may_be_the_same_vector)
{
  const Torn            torn(cut(box_on_circle(4, "100"), blocks(2)));
  const auto            problem = torn.dual();
  const Eigen::VectorXd x       = random_vector(torn.constraints.rows->size(), 1);
  auto                  y       = distributed(x, *problem);
  problem->dual_operator().apply(y, y);
  EXPECT_LT(relative_difference(gathered(y, MPI_COMM_WORLD), F_times(*problem, x)), 1e-15);
}
