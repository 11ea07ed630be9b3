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
      A.row(1).setZero(); // A alone need not be definite where it changes
      A.col(1).setZero();
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
          const CoarseSolver    solver(staying, change), fresh(n_owned, share_of(B), MPI_COMM_WORLD);
          const Eigen::VectorXd b = random_vector(n, seed), x = B.ldlt().solve(b);
          const auto            own = [&](const Eigen::VectorXd &all) { return all.segment(first, n_owned); };
          const Eigen::VectorXd y   = solver.solve(own(b));
          EXPECT_LT((y - own(x)).norm(), 1e-12 * x.norm()) << every;
          EXPECT_LT((y - fresh.solve(own(b))).norm(), 1e-12 * x.norm()) << every;
        }
    }
}

// Normals of oblique planes are orthogonal to an axis but for rounding; what stays then resists the motion along this
// axis by (1e-16)^2.
TEST(CoarseSolver, resistance_of_rounding_costs_no_digits)
{
  if (n_ranks() > 1)
    return;
  for (const int axis : {0, 1, 2})
    {
      Eigen::MatrixXd G(3, 4);
      G.row(axis) << 1.4e-16, 0, -1.4e-16, 1e-16;
      G.row((axis + 1) % 3) << 0.956, 0.292, 0.7, -0.292;
      G.row((axis + 2) % 3) << -0.292, 0.956, -0.2, 0.956;
      const Eigen::MatrixXd stays   = G * G.transpose();
      Eigen::MatrixXd       changes = Eigen::MatrixXd::Zero(3, 3);
      changes(axis, axis)           = 9;
      const Eigen::VectorXd b = random_vector(3, 1), x = (stays + changes).ldlt().solve(b);
      const auto            eliminated =
        CoarseSolver::eliminate(share_of(stays), {true, true, true}, MPI_COMM_WORLD, share_of(changes));
      const CoarseSolver solver(eliminated, share_of(changes));
      EXPECT_LT((solver.solve(b) - x).norm(), 1e-12 * x.norm());
    }
}

TEST(CoarseSolver, units_of_the_unknowns_do_not_matter)
{
  const unsigned int    n_owned = 20, n = n_owned * n_ranks(), first = n_owned * rank();
  const Eigen::MatrixXd A     = sparse_matrix(n);
  const Eigen::VectorXd units = Eigen::pow(10., 9 * random_vector(n, 5).array());
  std::vector<bool>     changes(n_owned);
  changes[2] = true;
  const auto staying =
    CoarseSolver::eliminate(share_of(units.asDiagonal() * A * units.asDiagonal()), changes, MPI_COMM_WORLD);
  const Eigen::VectorXd b = random_vector(n, 1), x = A.ldlt().solve(b);
  const Eigen::VectorXd y = CoarseSolver(staying, {}).solve(units.cwiseProduct(b).segment(first, n_owned));
  EXPECT_LT((y.cwiseProduct(units.segment(first, n_owned)) - x.segment(first, n_owned)).norm(), 1e-12 * x.norm());
}

TEST(CoarseSolver, factors_of_a_grid_hold_n_log_n_numbers_and_what_changes_adds_n)
{
  const unsigned int    m = 40, n = m * m;
  CoarseSolver::Entries laplacian;
  const auto            add = [&](const unsigned int i, const unsigned int j, const double value) {
    if (rank() == 0)
      laplacian.push_back({std::max(i, j), std::min(i, j), value});
  };
  for (unsigned int i = 0; i < n; ++i)
    {
      add(i, i, 4.1);
      if (i % m > 0)
        add(i, i - 1, -1);
      if (i >= m)
        add(i, i - m, -1);
    }
  std::vector<bool> changes(rank() == 0 ? n : 0);
  std::fill_n(changes.begin(), rank() == 0 ? m : 0, true); // one side
  const auto         staying = CoarseSolver::eliminate(laplacian, changes, MPI_COMM_WORLD);
  const CoarseSolver one(staying, {}), both(rank() == 0 ? n : 0, laplacian, MPI_COMM_WORLD);
  EXPECT_LT(both.n_nonzeros(), 3 * n * std::log2(n)); // the band of a row by row ordering has m n = 3.8 of them
  // three dense matrices of m^2 = n numbers, and the fill of a side that comes last; columns of A^-1 would be m n = 40 n
  EXPECT_LT(one.n_nonzeros(), both.n_nonzeros() + 8 * n);
}

TEST(CoarseSolver, matrix_without_rows_is_no_error)
{
  const CoarseSolver solver(0, {}, MPI_COMM_WORLD);
  EXPECT_EQ(solver.dimension(), 0u);
  EXPECT_EQ(solver.solve(Eigen::VectorXd(0)).size(), 0);
}

TEST(CoarseSolver, singular_and_indefinite_matrices_are_errors_on_all_ranks)
{
  const bool is_owner = rank() == 0;
  for (const double pivot : {0., -0.1})
    for (const bool changes : {false, true}) // where all changes, and where what stays is eliminated
      for (const bool where_it_changes : {false, true})
        message_on_all_ranks<NumericalError>([&] {
          Eigen::MatrixXd A = Eigen::MatrixXd::Identity(60, 60);
          A(30, 31) = A(31, 30) = 0.5;
          A(30, 30)             = pivot + (pivot == 0 ? 0.25 : 0.); // less 0.25, once 31 is eliminated
          std::vector<bool> changing(is_owner ? 60 : 0, changes);
          if (is_owner && where_it_changes)
            changing[30] = true;
          const CoarseSolver solver(CoarseSolver::eliminate(share_of(A), changing, MPI_COMM_WORLD), {});
        });
}
