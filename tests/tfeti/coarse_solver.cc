#include "torn.h"

#include <slipstick/base/exceptions.h>
#include <slipstick/tfeti/coarse_solver.h>

using namespace slipstick;
using namespace slipstick::test;
using tfeti::CoarseSolver;

namespace
{
  unsigned int rank()
  {
    return dealii::Utilities::MPI::this_mpi_process(MPI_COMM_WORLD);
  }
  unsigned int n_ranks()
  {
    return dealii::Utilities::MPI::n_mpi_processes(MPI_COMM_WORLD);
  }

  /// Symmetric positive definite with zeros; the same on all ranks.
  Eigen::MatrixXd sparse_matrix(const unsigned int n)
  {
    Eigen::MatrixXd A = Eigen::MatrixXd::Zero(n, n);
    for (unsigned int i = 0; i < n; ++i)
      for (unsigned int k = 0; k < 3; ++k)
        {
          const Eigen::VectorXd r = random_vector(1, 10 * i + k);
          const unsigned int    j = (i + 1 + 5 * k) % n;
          A(i, j) += r[0];
          A(j, i) += r[0];
        }
    return A * A.transpose() + Eigen::MatrixXd::Identity(n, n);
  }

  /// Every rank gives its share of every nonzero entry; the shares sum to A.
  CoarseSolver::Entries share_of(const Eigen::MatrixXd &A)
  {
    CoarseSolver::Entries entries;
    const double          all = n_ranks() * (n_ranks() + 1) / 2.;
    for (int i = 0; i < A.rows(); ++i)
      for (int j = 0; j < A.cols(); ++j)
        if (A(i, j) != 0)
          for (const double part : {0.25, 0.75}) // entries of one position add up
            entries.push_back({i, j, part * A(i, j) * (rank() + 1) / all});
    return entries;
  }

  void expect_solves(const unsigned int n_owned)
  {
    const auto   owned = dealii::Utilities::MPI::all_gather(MPI_COMM_WORLD, n_owned);
    unsigned int n = 0, first = 0;
    for (unsigned int r = 0; r < owned.size(); ++r)
      {
        first += r < rank() ? owned[r] : 0;
        n += owned[r];
      }
    const Eigen::MatrixXd A = sparse_matrix(n);
    const CoarseSolver    solver(n_owned, share_of(A), MPI_COMM_WORLD);
    EXPECT_EQ(solver.dimension(), n);
    for (const unsigned int seed : {1, 2})
      {
        const Eigen::VectorXd b = random_vector(n, seed), x = A.ldlt().solve(b);
        const Eigen::VectorXd own = solver.solve(b.segment(first, n_owned));
        ASSERT_EQ(own.size(), n_owned);
        EXPECT_LT((own - x.segment(first, n_owned)).norm(), 1e-12 * x.norm());
      }
  }
} // namespace

TEST(CoarseSolver, agrees_with_a_dense_solve_when_all_ranks_give_to_all_entries)
{
  expect_solves(7);
}

TEST(CoarseSolver, agrees_with_a_dense_solve_when_ranks_own_different_numbers)
{
  expect_solves(5 + 3 * rank());
}

TEST(CoarseSolver, agrees_with_a_dense_solve_when_one_rank_owns_all)
{
  for (const unsigned int owner : {0u, n_ranks() - 1})
    expect_solves(rank() == owner ? 9 : 0);
}

TEST(CoarseSolver, eliminates_what_stays_once_for_several_changes_elsewhere)
{
  // few changing unknowns are eliminated to, many are not: both ways
  for (const unsigned int every : {3u, 12u, 1000u})
    {
      const unsigned int n_owned = 40, n = n_owned * n_ranks(), first = n_owned * rank();
      Eigen::MatrixXd    A = sparse_matrix(n);
      std::vector<bool>  changes(n_owned);
      for (unsigned int i = 0; i < n_owned; ++i)
        changes[i] = (first + i) % every == 1;
      A(1, 1) -= 2; // A alone need not be definite where it changes
      const auto staying = CoarseSolver::eliminate(share_of(A), changes, MPI_COMM_WORLD);
      for (const unsigned int seed : {1, 2, 3})
        {
          Eigen::MatrixXd       B = A;
          CoarseSolver::Entries change;
          for (unsigned int i = 1; i < n; i += every)
            for (unsigned int j = 1; j < n; j += every)
              {
                const double value = i == j ? 3. + seed : 0.01 * std::sin(seed * i * j);
                B(i, j) += value;
                if (rank() == (i + j) % n_ranks())
                  change.push_back({i, j, value});
              }
          const CoarseSolver    solver(staying, change);
          const Eigen::VectorXd b = random_vector(n, seed), x = B.ldlt().solve(b);
          EXPECT_LT((solver.solve(b.segment(first, n_owned)) - x.segment(first, n_owned)).norm(), 1e-12 * x.norm())
            << every;
        }
    }
}

TEST(CoarseSolver, matrix_without_rows_is_no_error)
{
  const CoarseSolver solver(0, {}, MPI_COMM_WORLD);
  EXPECT_EQ(solver.dimension(), 0u);
  EXPECT_EQ(solver.solve(Eigen::VectorXd(0)).size(), 0);
}

TEST(CoarseSolver, singular_matrix_is_an_error_on_all_ranks)
{
  const Eigen::VectorXd v        = random_vector(6, 3);
  const bool            is_owner = rank() == 0;
  message_on_all_ranks<NumericalError>([&] {
    Eigen::MatrixXd A = Eigen::MatrixXd::Identity(6, 6);
    A(3, 3)           = 0;
    CoarseSolver(is_owner ? 6 : 0, share_of(A), MPI_COMM_WORLD);
  });
}
