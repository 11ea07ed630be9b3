// Direct solver for the coarse matrix (Trilinos Tpetra, Amesos2 KLU2).
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

    /// @param n_owned rows of this rank, which follow those of the rank before. Collective.
    /// @throws NumericalError when the matrix is singular.
    CoarseSolver(const unsigned int n_owned, const Entries &entries, const MPI_Comm comm);
    ~CoarseSolver();

    /// x = A^-1 b, owned rows. Collective.
    Eigen::VectorXd solve(const Eigen::VectorXd &b) const;

    unsigned long long dimension() const;

  private:
    struct Trilinos;

    MPI_Comm                  comm;
    unsigned int              n_owned;
    std::vector<int>          first_of_rank, n_of_rank;
    std::unique_ptr<Trilinos> trilinos;
  };
} // namespace slipstick::tfeti
