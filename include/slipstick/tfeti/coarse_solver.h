// Direct solver for the coarse matrix, distributed by rows (Trilinos Tpetra, Amesos2).
#pragma once

#include <Eigen/Dense>

#include <mpi.h>

#include <map>
#include <memory>
#include <utility>

namespace slipstick::tfeti
{
  /// Sparse symmetric positive definite matrix of small dense blocks, factorised once.
  class CoarseSolver
  {
  public:
    /// Entries by global row and column; entries of one position given by several ranks are added.
    using Entries = std::map<std::pair<long long, long long>, double>;

    /// @param n_owned rows of this rank, which follow those of the rank before. Collective.
    /// @throws NumericalError when the matrix is singular.
    CoarseSolver(const unsigned int n_owned, const Entries &entries, const MPI_Comm comm);
    ~CoarseSolver();

    /// x = A^-1 b, owned rows. Collective.
    Eigen::VectorXd solve(const Eigen::VectorXd &b) const;

    unsigned long long dimension() const;

  private:
    struct Trilinos;
    std::unique_ptr<Trilinos> trilinos;
  };
} // namespace slipstick::tfeti
