// Direct solver (CHOLMOD, nested dissection) for coarse matrices that differ only in a few rows and columns.
#pragma once

#include <Eigen/Dense>

#include <mpi.h>

#include <memory>
#include <vector>

namespace slipstick::tfeti
{
  /// Sparse symmetric positive definite matrix, factorised once; in the plane L has O(n log n) entries, with the
  /// unknowns ordered by nested dissection (George 1973). Right-hand sides and solutions are distributed over the
  /// ranks; the matrix, whose size is that of the kernel, is stored and factorised on every rank, so that a solve costs
  /// one gather (benchmarks/coarse_problem.md: up to which size this pays off).
  ///
  /// Matrices A + C_1, A + C_2, .. whose C_i are nonzero only in the rows and columns of a few changing unknowns share
  /// the elimination of all other unknowns; each factorises only its Schur complement on the changing ones. If many
  /// unknowns change, the matrices share the ordering and the pattern of L.
  /// @code
  /// const CoarseSolver    solver(2, {{0, 0, 2.}, {1, 0, -1.}, {1, 1, 2.}}, MPI_COMM_SELF); // entries above the diagonal follow
  /// const Eigen::VectorXd x = solver.solve(Eigen::Vector2d(3, 0));
  /// assert((x - Eigen::Vector2d(2, 1)).norm() < 1e-12);
  /// @endcode
  class CoarseSolver
  {
  public:
    /// An entry by global row and column. Entries at the same position, also of different ranks, are added. Entries
    /// above the diagonal are ignored.
    struct Entry
    {
      long long row, column;
      double    value;
    };
    using Entries = std::vector<Entry>;

    class Elimination;

    /// @param n_owned number of rows of this rank, numbered after those of the previous rank. Collective.
    /// @throws NumericalError when the matrix is not positive definite.
    CoarseSolver(const unsigned int n_owned, const Entries &entries, const MPI_Comm comm);

    /// Eliminates all but the changing unknowns from A, which may be semidefinite.
    /// @param changes for each row of this rank: whether it changes.
    /// @param largest_changes entries of the sum of all C; only its diagonal is used, to scale the changing unknowns,
    /// which A alone may resist by rounding only. Collective.
    /// @throws NumericalError when A without the changing rows and columns is not positive definite.
    static std::shared_ptr<const Elimination> eliminate(const Entries           &entries,
                                                        const std::vector<bool> &changes,
                                                        const MPI_Comm           comm,
                                                        const Entries           &largest_changes = {});

    /// Factorises A + C.
    /// @param changing entries of C, in changing rows and columns; store zeros where other C_i have entries to keep the
    /// pattern the same. Collective.
    /// @throws NumericalError when the matrix is not positive definite.
    CoarseSolver(std::shared_ptr<const Elimination> staying, const Entries &changing);
    ~CoarseSolver();

    /// x = (A + C)^-1 b, owned rows. Collective.
    Eigen::VectorXd solve(const Eigen::VectorXd &b) const;

    unsigned long long dimension() const;

    /// Numbers stored on this rank for factors, shared ones included.
    std::size_t n_nonzeros() const;

  private:
    class Factor;

    std::shared_ptr<const Elimination> staying;
    std::unique_ptr<const Factor>      factor;
  };
} // namespace slipstick::tfeti
