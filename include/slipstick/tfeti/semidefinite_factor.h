// Sparse L D L' of a symmetric positive semidefinite matrix whose rows may be linearly dependent.
#pragma once

#include <Eigen/SparseCore>

#include <vector>

namespace slipstick::tfeti
{
  /// P A P' = L D L' with a fill-reducing order P. A row that depends on those before it (its pivot is no larger than
  /// the rounding of its diagonal entry) is skipped: its entry in a solution is 0. For a right-hand side in the range
  /// of A the result solves A x = b. Up-looking elimination, Davis 2005 (LDL).
  /// @code
  /// Eigen::Matrix2d spring; // held nowhere: a translation costs nothing
  /// spring << 2, -2, -2, 2;
  /// const SemidefiniteFactor factor(spring.sparseView());
  /// const Eigen::VectorXd    u = factor.solve(Eigen::Vector2d(-6, 6));
  /// assert(factor.left_out().size() == 1);
  /// assert(std::abs(u[1] - u[0] - 3) < 1e-12);
  /// @endcode
  class SemidefiniteFactor
  {
  public:
    /// @p matrix: full symmetric, both triangles.
    explicit SemidefiniteFactor(const Eigen::SparseMatrix<double> &matrix);

    Eigen::VectorXd solve(const Eigen::VectorXd &b) const;

    /// The rows that were skipped.
    const std::vector<unsigned int> &left_out() const
    {
      return skipped;
    }

  private:
    std::vector<int>          order;      // of the rows: order[k] is eliminated as the k-th
    std::vector<int>          first, row; // columns of L below the diagonal
    std::vector<double>       value, inverse_pivot;
    std::vector<unsigned int> skipped;
  };
} // namespace slipstick::tfeti
