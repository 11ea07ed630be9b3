// Dense decompositions of small matrices, instantiated in one place: Eigen's templates for them take longest to
// compile.
#pragma once

#include <Eigen/Dense>

namespace slipstick::tfeti
{
  /// Eigenvalues of a symmetric matrix, ascending, and eigenvectors of unit length as columns.
  struct SymmetricEigen
  {
    explicit SymmetricEigen(const Eigen::MatrixXd &matrix);

    Eigen::VectorXd values;
    Eigen::MatrixXd vectors;
  };

  /// Only the eigenvalues, ascending.
  Eigen::VectorXd symmetric_eigenvalues(const Eigen::MatrixXd &matrix);

  /// The x that minimises |A x - b|; the shortest one if there are several.
  /// @param rounding pivots of A below this part of the largest are zero.
  Eigen::VectorXd shortest_solution(const Eigen::MatrixXd &A, const Eigen::VectorXd &b, double rounding = 1e-14);

  /// An x that minimises |A x - b| with at most rank(A) nonzero entries (pivoted QR).
  Eigen::VectorXd basic_solution(const Eigen::MatrixXd &A, const Eigen::VectorXd &b);
} // namespace slipstick::tfeti
