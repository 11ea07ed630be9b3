// Direct solver for coarse matrices (Trilinos Tpetra, Amesos2 KLU2) that differ in few of their rows and columns.
#pragma once

#include <Eigen/Dense>

#include <mpi.h>

#include <memory>
#include <vector>

namespace slipstick::tfeti
{
  /// Sparse symmetric positive definite matrix, factorised once. Right-hand sides and solutions are distributed over the
  /// ranks; the matrix, whose size is that of the kernel, is held and factorised by every rank, so that a solve costs
  /// one gather. (KLU2 with a distributed matrix is wrong in Trilinos 13.2, see doc/decisions.md.)
  ///
  /// Matrices A + C_1, A + C_2, .. with C_i in the rows and columns of a few changing unknowns share the elimination of
  /// all others; each factorises its Schur complement in the changing ones alone.
  class CoarseSolver
  {
  public:
    /// An entry by global row and column; entries of one position, of whatever rank, are added.
    struct Entry
    {
      long long row, column;
      double    value;
    };
    using Entries = std::vector<Entry>;

    class Elimination;

    /// @param n_owned rows of this rank, which follow those of the rank before. Collective.
    /// @throws NumericalError when the matrix is singular.
    CoarseSolver(const unsigned int n_owned, const Entries &entries, const MPI_Comm comm);

    /// Eliminates all but the changing unknowns from A.
    /// @param changes of the rows of this rank, in their order. Collective.
    /// @throws NumericalError when A without the changing rows and columns is singular.
    static std::shared_ptr<const Elimination> eliminate(const Entries           &entries,
                                                        const std::vector<bool> &changes,
                                                        const MPI_Comm           comm);

    /// Of A + C. @param changing entries of C, of changing rows and columns. Collective.
    /// @throws NumericalError when the matrix is singular.
    CoarseSolver(std::shared_ptr<const Elimination> staying, const Entries &changing);
    ~CoarseSolver();

    /// x = (A + C)^-1 b, owned rows. Collective.
    Eigen::VectorXd solve(const Eigen::VectorXd &b) const;

    unsigned long long dimension() const;

  private:
    class Factor;

    std::shared_ptr<const Elimination> staying;
    std::unique_ptr<const Factor>      complement; // Schur complement in the changing unknowns
  };
} // namespace slipstick::tfeti
