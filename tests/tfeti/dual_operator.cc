#include "torn.h"

#include <slipstick/tfeti/operator_choice.h>

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
      const Eigen::VectorXd x         = random_vector(torn.constraints.rows->size(), 1);
      const auto            blockwise = dual(torn, tfeti::DualOperatorKind::explicit_blocks),
                 by_solves            = dual(torn, tfeti::DualOperatorKind::implicit);
      EXPECT_TRUE(blockwise->subdomains().empty() || blockwise->dual_operator().is_explicit());
      EXPECT_FALSE(by_solves->dual_operator().is_explicit());
      EXPECT_LT(relative_difference(F_times(*blockwise, x), F_times(*by_solves, x)), 1e-11) << name;
    }
}

TEST(DualOperator, single_precision_is_near_double_and_half_as_large)
{
  for (const auto &[name, scene] : scenes())
    {
      const Torn            torn(scene);
      const Eigen::VectorXd x = random_vector(torn.constraints.rows->size(), 1), y = random_vector(x.size(), 2);
      tfeti::DualOptions    options;
      options.dual_operator           = tfeti::DualOperatorKind::explicit_blocks;
      const auto in_double            = torn.dual(options);
      options.operator_precision      = tfeti::Precision::single_precision;
      const auto            in_single = torn.dual(options);
      const Eigen::VectorXd Fx = F_times(*in_double, x), approximate = F_times(*in_single, x);
      EXPECT_LT(relative_difference(approximate, Fx), 1e-6) << name;
      EXPECT_GT(relative_difference(approximate, Fx), 1e-10) << name;
      EXPECT_LT(std::abs(y.dot(approximate) - x.dot(F_times(*in_single, y))), 1e-12 * Fx.norm() * y.norm()) << name;
      EXPECT_EQ(2 * in_single->dual_operator().block_bytes(), in_double->dual_operator().block_bytes());
      auto by_solves = in_single->zero();
      in_single->dual_operator().apply_by_solves(distributed(x, *in_single), by_solves);
      EXPECT_LT(relative_difference(gathered(by_solves, MPI_COMM_WORLD), Fx), 1e-11) << name;
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
        const Eigen::VectorXd eigenvalues = tfeti::symmetric_eigenvalues(F);
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

TEST(OperatorChoice, blocks_pay_unless_nearly_all_unknowns_are_touched)
{
  tfeti::DualOptions options;
  const auto         gain = [&](const std::size_t n_unknowns, const std::size_t n_touched) {
    const auto estimate = tfeti::estimate_block(n_unknowns, n_touched, options);
    return 40 * estimate.saving - estimate.setup;
  };
  for (const std::size_t n : {5, 10, 50, 100, 200}) // cells along the edge of a block
    EXPECT_GT(gain(2 * (n + 1) * (n + 1), 8 * n), 0) << n;
  EXPECT_LT(gain(5202, 3000), 0);
}

TEST(OperatorChoice, memory_of_a_block_is_that_of_its_triangles)
{
  tfeti::DualOptions options;
  const std::size_t  packed = 400 * 401 / 2;
  EXPECT_EQ(tfeti::estimate_block(5202, 400, options).bytes, packed * sizeof(double));
  options.preconditioner = tfeti::Preconditioner::dirichlet;
  EXPECT_EQ(tfeti::estimate_block(5202, 400, options).bytes, packed * (sizeof(double) + sizeof(float)));
  options.operator_precision = tfeti::Precision::single_precision;
  EXPECT_EQ(tfeti::estimate_block(5202, 400, options).bytes, packed * 2 * sizeof(float));
}

TEST(OperatorChoice, automatic_goes_by_the_gain_and_the_user_overrules)
{
  const std::vector<unsigned int> n_unknowns = {1000};
  tfeti::Constraints              few, many;
  few.blocks.resize(1);
  many.blocks.resize(1);
  for (unsigned int i = 0; i < 1000; ++i)
    {
      many.blocks[0].push_back({i, i, 1.});
      if (i % 10 == 0)
        few.blocks[0].push_back({i, i, 1.});
    }
  tfeti::DualOptions options;
  EXPECT_TRUE(tfeti::is_explicit(options, n_unknowns, few, MPI_COMM_WORLD));
  EXPECT_FALSE(tfeti::is_explicit(options, n_unknowns, many, MPI_COMM_WORLD));
  options.dual_operator = tfeti::DualOperatorKind::explicit_blocks;
  EXPECT_TRUE(tfeti::is_explicit(options, n_unknowns, many, MPI_COMM_WORLD));
  options.dual_operator = tfeti::DualOperatorKind::implicit;
  EXPECT_FALSE(tfeti::is_explicit(options, n_unknowns, few, MPI_COMM_WORLD));
}

TEST(PackedSymmetric, product_is_that_of_the_stored_numbers)
{
  for (const unsigned int n : {1, 2, 3, 7, 8, 9, 16, 17, 64, 131})
    {
      const Eigen::MatrixXd full = [n] {
        Eigen::MatrixXd A(n, n);
        for (unsigned int j = 0; j < n; ++j)
          A.col(j) = random_vector(n, j);
        return Eigen::MatrixXd(A + A.transpose());
      }();
      std::vector<unsigned int> order(n);
      for (unsigned int k = 0; k < n; ++k)
        order[k] = (k + n / 2) % n;
      const Eigen::MatrixXd        ordered = full(order, order), rounded = ordered.cast<float>().cast<double>();
      const Eigen::VectorXd        x = random_vector(n, 77);
      Eigen::VectorXd              y;
      const tfeti::PackedSymmetric in_double(full, order, tfeti::Precision::double_precision);
      const tfeti::PackedSymmetric in_single(full, order, tfeti::Precision::single_precision);
      in_double.multiply(x, y);
      EXPECT_LT((y - ordered * x).norm(), 1e-14 * full.norm() * x.norm()) << n;
      in_single.multiply(x, y);
      EXPECT_LT((y - rounded * x).norm(), 1e-14 * full.norm() * x.norm()) << n;
      EXPECT_EQ(in_double.full(), ordered) << n;
      EXPECT_EQ(in_single.full(), rounded) << n;
    }
}

TEST(PackedSymmetric, product_and_inverse_of_a_factor)
{
  for (const unsigned int n : {1, 5, 63, 64, 65, 130})
    {
      Eigen::MatrixXd L = Eigen::MatrixXd::Identity(n, n);
      for (unsigned int j = 0; j < n; ++j)
        L.col(j).tail(n - j) += random_vector(n, j).tail(n - j) / n;
      EXPECT_LT((tfeti::product_of_factor(L) - L * L.transpose()).norm(), 1e-13 * L.squaredNorm()) << n;
      EXPECT_LT((tfeti::inverse_of_product(L) * L * L.transpose() - Eigen::MatrixXd::Identity(n, n)).norm(), 1e-11)
        << n;
    }
}
