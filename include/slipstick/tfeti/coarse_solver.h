// Direct solver for coarse matrices (CHOLMOD, nested dissection) that differ in few of their rows and columns.
#pragma once

#include <Eigen/Dense>

#include <mpi.h>

#include <memory>
#include <vector>

namespace slipstick::tfeti
{
  /// Sparse symmetric positive definite matrix, factorised once: L L' of n log n numbers in the plane, unknowns ordered by
  /// nested dissection (George 1973). Right-hand sides and solutions are distributed over the ranks; the matrix, whose size is
  /// that of the kernel, is held and factorised by every rank, so that a solve costs one gather (benchmarks/coarse_problem.md
  /// says up to which size that pays).
  ///
  /// Matrices A + C_1, A + C_2, .. with C_i in the rows and columns of a few changing unknowns share the elimination of
  /// all others; each factorises its Schur complement in the changing ones alone. Where many change, they share the
  /// ordering and the pattern of L.
  /// @code
  /// const CoarseSolver    solver(2, {{0, 0, 2.}, {1, 0, -1.}, {1, 1, 2.}}, MPI_COMM_SELF); // entries above the diagonal follow
  /// const Eigen::VectorXd x = solver.solve(Eigen::Vector2d(3, 0));
  /// assert((x - Eigen::Vector2d(2, 1)).norm() < 1e-12);
  /// @endcode
  class CoarseSolver
  {
  public:
    /// An entry by global row and column; entries of one position, of any rank, are added. Those above the diagonal
    /// are not read.
    struct Entry
    {
      long long row, column;
      double    value;
    };
    using Entries = std::vector<Entry>;

    class Elimination;

    /// @param n_owned rows of this rank, which follow those of the rank before. Collective.
    /// @throws NumericalError when the matrix is not positive definite.
    CoarseSolver(const unsigned int n_owned, const Entries &entries, const MPI_Comm comm);

    /// Eliminates all but the changing unknowns from A, which need be semidefinite only.
    /// @param changes of the rows of this rank, in their order. Collective.
    /// @throws NumericalError when A without the changing rows and columns is not positive definite.
    static std::shared_ptr<const Elimination> eliminate(const Entries           &entries,
                                                        const std::vector<bool> &changes,
                                                        const MPI_Comm           comm);

    /// Of A + C. @param changing entries of C, of changing rows and columns; zeros where other C_i have entries keep the
    /// pattern the same. Collective.
    /// @throws NumericalError when the matrix is not positive definite.
    CoarseSolver(std::shared_ptr<const Elimination> staying, const Entries &changing);
    ~CoarseSolver();

    /// x = (A + C)^-1 b, owned rows. Collective.
    Eigen::VectorXd solve(const Eigen::VectorXd &b) const;

    unsigned long long dimension() const;

    /// Numbers that this rank holds for factors: those that are shared, and its own.
    std::size_t n_nonzeros() const;

  private:
    class Factor;

    std::shared_ptr<const Elimination> staying;
    std::unique_ptr<const Factor>      factor;
  };
} // namespace slipstick::tfeti
