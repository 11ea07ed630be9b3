// Dense decompositions of small matrices, compiled once: Eigen's templates of them are the most costly to compile.
#pragma once

#include <Eigen/Dense>

namespace slipstick::tfeti
{
  /// Of a symmetric matrix: eigenvalues, ascending, and eigenvectors of unit length as columns.
  struct SymmetricEigen
  {
    explicit SymmetricEigen(const Eigen::MatrixXd &matrix);

    Eigen::VectorXd values;
    Eigen::MatrixXd vectors;
  };

  /// The eigenvalues alone, ascending.
  Eigen::VectorXd symmetric_eigenvalues(const Eigen::MatrixXd &matrix);

  /// x with the least |A x - b|; of several the shortest.
  Eigen::VectorXd shortest_solution(const Eigen::MatrixXd &A, const Eigen::VectorXd &b);

  /// x with the least |A x - b| and no more entries than the rank of A (pivoted QR).
  Eigen::VectorXd basic_solution(const Eigen::MatrixXd &A, const Eigen::VectorXd &b);
} // namespace slipstick::tfeti
