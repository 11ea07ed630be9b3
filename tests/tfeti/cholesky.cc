#include "torn.h"

#include <slipstick/base/exceptions.h>

#include <SuiteSparse_config.h>

#include <cstdlib>
#include <new>

using namespace slipstick;
using namespace slipstick::test;
using tfeti::Cholesky;
using tfeti::CholmodSession;

namespace
{
  /// Stiffness of the box with 1 added to its diagonal: positive definite, with fill.
  Eigen::SparseMatrix<double> shifted_stiffness(const unsigned int n)
  {
    Eigen::SparseMatrix<double> lower = Torn(box(n), MPI_COMM_SELF).matrices[0].stiffness / 1e5;
    for (int i = 0; i < lower.rows(); ++i)
      lower.coeffRef(i, i) += 1;
    return lower;
  }

  std::vector<unsigned int> every(const unsigned int step, const unsigned int n)
  {
    std::vector<unsigned int> list;
    for (unsigned int i = 0; i < n; i += step)
      list.push_back(i);
    return list;
  }

  const auto session = [] { return std::make_shared<CholmodSession>(); };

#if SUITESPARSE_MAIN_VERSION < 6 // later ones hide the functions behind others
  /// While one of these exists, CHOLMOD runs out of memory after a number of allocations.
  class Shortage
  {
  public:
    explicit Shortage(const int n_allocations)
      : before(SuiteSparse_config)
    {
      left                           = n_allocations;
      SuiteSparse_config.malloc_func = [](std::size_t n) { return left-- > 0 ? std::malloc(n) : nullptr; };
      SuiteSparse_config.calloc_func = [](std::size_t n, std::size_t s) {
        return left-- > 0 ? std::calloc(n, s) : nullptr;
      };
      SuiteSparse_config.realloc_func = [](void *p, std::size_t n) {
        return left-- > 0 ? std::realloc(p, n) : nullptr;
      };
    }
    ~Shortage()
    {
      SuiteSparse_config = before;
    }

  private:
    const SuiteSparse_config_struct before;
    static inline int               left = 0;
  };
#endif
} // namespace

#if SUITESPARSE_MAIN_VERSION < 6
TEST(Cholesky, lack_of_memory_anywhere_is_bad_alloc)
{
  const auto A = shifted_stiffness(4);
  for (const auto &last : {std::vector<unsigned int>(), every(5, A.rows())})
    for (const auto ordering : {tfeti::Ordering::minimum_degree, tfeti::Ordering::nested_dissection})
      {
        int n = 0;
        for (bool ran_out = true; ran_out; ++n)
          {
            ASSERT_LT(n, 1000);
            const auto      memory = std::make_shared<CholmodSession>(ordering);
            Eigen::VectorXd x      = random_vector(A.rows(), 1);
            const Shortage  shortage(n);
            try
              {
                Cholesky(memory, A, last, "box").solve(x);
                ran_out = false;
              }
            catch (const std::bad_alloc &)
              {}
          }
        EXPECT_GT(n, 10);
      }
}
#endif

TEST(Cholesky, solves)
{
  const auto A = shifted_stiffness(6);
  for (const auto &last : {std::vector<unsigned int>(), every(5, A.rows()), every(1, A.rows())})
    {
      const Cholesky        factor(session(), A, last, "box");
      const Eigen::VectorXd x = random_vector(A.rows(), 1);
      Eigen::VectorXd       y = A.selfadjointView<Eigen::Lower>() * x;
      factor.solve(y);
      EXPECT_LT(relative_difference(y, x), 1e-13);
    }
}

TEST(Cholesky, solves_for_several_columns)
{
  const auto      A = shifted_stiffness(6);
  const Cholesky  factor(session(), A, {}, "box");
  Eigen::MatrixXd x(A.rows(), 3);
  for (unsigned int k = 0; k < 3; ++k)
    x.col(k) = random_vector(A.rows(), k);
  Eigen::MatrixXd y = A.selfadjointView<Eigen::Lower>() * x;
  factor.solve(y);
  EXPECT_LT(relative_difference(y, x), 1e-13);
}

TEST(Cholesky, matrices_that_differ_by_rounding_share_a_factor_while_one_of_them_lives)
{
  const auto A = shifted_stiffness(5);
  auto       B = A, C = A;
  B *= 1 + 1e-15;
  C.coeffRef(7, 7) *= 1 + 1e-9;
  const auto common = session();
  auto       a      = std::make_unique<Cholesky>(common, A, std::vector<unsigned int>(), "a");
  const auto b      = std::make_unique<Cholesky>(common, B, std::vector<unsigned int>(), "b");
  const auto c      = std::make_unique<Cholesky>(common, C, std::vector<unsigned int>(), "c");
  EXPECT_EQ(a->identity(), b->identity());
  EXPECT_NE(a->identity(), c->identity());
  a.reset();
  const Cholesky d(common, A, {}, "d");
  EXPECT_EQ(d.identity(), b->identity());
  using Solved = std::pair<const Cholesky *, const Eigen::SparseMatrix<double> *>;
  for (const auto &[factor, matrix] : {Solved(b.get(), &B), Solved(c.get(), &C), Solved(&d, &A)})
    {
      const Eigen::VectorXd x = random_vector(A.rows(), 2);
      Eigen::VectorXd       y = matrix->selfadjointView<Eigen::Lower>() * x;
      factor->solve(y);
      EXPECT_LT(relative_difference(y, x), 1e-12);
    }
}

TEST(Cholesky, trailing_block_is_the_factor_of_the_schur_complement)
{
  const auto A = shifted_stiffness(7);
  for (const unsigned int step : {1, 2, 3, 7, 50, 1000})
    {
      const auto      last = every(step, A.rows());
      const Cholesky  factor(session(), A, last, "box");
      const auto     &order   = factor.last_order();
      Eigen::MatrixXd inverse = full(A).inverse(), of_last(order.size(), order.size());
      for (unsigned int i = 0; i < order.size(); ++i)
        for (unsigned int j = 0; j < order.size(); ++j)
          of_last(i, j) = inverse(order[i], order[j]);
      const Eigen::MatrixXd L = factor.trailing_block();
      EXPECT_LT(relative_difference(L * L.transpose(), of_last.inverse()), 1e-13) << step;
    }
}

TEST(Cholesky, trailing_block_is_lower_triangular)
{
  const auto            A = shifted_stiffness(4);
  const Eigen::MatrixXd L = Cholesky(session(), A, every(3, A.rows()), "box").trailing_block();
  EXPECT_EQ(Eigen::MatrixXd(L.triangularView<Eigen::StrictlyUpper>()).norm(), 0);
}

TEST(Cholesky, last_order_is_a_permutation_of_the_last_unknowns)
{
  const auto A     = shifted_stiffness(4);
  const auto last  = every(3, A.rows());
  auto       order = Cholesky(session(), A, last, "box").last_order();
  std::sort(order.begin(), order.end());
  EXPECT_EQ(order, last);
}

TEST(Cholesky, session_may_change_between_orderings)
{
  const auto     A      = shifted_stiffness(5);
  const auto     common = session();
  const Cholesky first(common, A, every(4, A.rows()), "a"), second(common, A, {}, "b"),
    third(common, A, every(2, A.rows()), "c");
  const Eigen::VectorXd x = random_vector(A.rows(), 2);
  for (const Cholesky *factor : {&first, &second, &third})
    {
      Eigen::VectorXd y = A.selfadjointView<Eigen::Lower>() * x;
      factor->solve(y);
      EXPECT_LT(relative_difference(y, x), 1e-13);
    }
}

TEST(Cholesky, matrices_of_one_pattern_are_analysed_once)
{
  const auto A = shifted_stiffness(5);
  auto       B = A;
  for (int i = 0; i < B.rows(); ++i)
    B.coeffRef(i, i) += i;
  const auto     C      = shifted_stiffness(6);
  const auto     common = session();
  const auto     last   = every(3, A.rows());
  const Cholesky a(common, A, last, "a"), b(common, B, last, "b");
  EXPECT_EQ(common->n_analyses(), 1u);
  const Cholesky c(common, C, last, "c"), d(common, B, every(4, A.rows()), "d"), e(common, B, {}, "e");
  EXPECT_EQ(common->n_analyses(), 4u);
  common->forget_analyses();
  EXPECT_EQ(common->n_analyses(), 0u);
  for (const auto &[factor, matrix] : {std::pair(&a, &A), {&b, &B}, {&c, &C}, {&d, &B}, {&e, &B}})
    {
      const Eigen::VectorXd x = random_vector(matrix->rows(), 2);
      Eigen::VectorXd       y = matrix->selfadjointView<Eigen::Lower>() * x;
      factor->solve(y);
      EXPECT_LT(relative_difference(y, x), 1e-13);
    }
}

TEST(Cholesky, more_patterns_than_are_kept_are_solved_all_the_same)
{
  const auto A      = shifted_stiffness(5);
  const auto common = session();
  for (unsigned int round = 0; round < 2; ++round)
    for (unsigned int step = 1; step < 45; ++step)
      {
        const Cholesky        factor(common, A, every(step, A.rows()), "a");
        const Eigen::VectorXd x = random_vector(A.rows(), step);
        Eigen::VectorXd       y = A.selfadjointView<Eigen::Lower>() * x;
        factor.solve(y);
        EXPECT_LT(relative_difference(y, x), 1e-13);
      }
}

TEST(Cholesky, indefinite_and_singular_matrices_are_named)
{
  auto indefinite = shifted_stiffness(3), singular = indefinite;
  indefinite.coeffRef(7, 7) = -1;
  for (int i = 0; i < singular.rows(); ++i)
    singular.coeffRef(i, i) -= 1;
  for (const auto &A : {indefinite, singular})
    for (const auto &last : {std::vector<unsigned int>(), every(3, A.rows())})
      try
        {
          Cholesky(session(), A, last, "subdomain 7");
          ADD_FAILURE() << "not thrown";
        }
      catch (const InputError &error)
        {
          EXPECT_NE(std::string(error.what()).find("subdomain 7"), std::string::npos);
        }
}
