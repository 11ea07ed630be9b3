// Directions that a sparse positive semidefinite matrix hardly resists. Nearly always there are none, which should cost
// little to find out.
#pragma once

#include <Eigen/Core>
#include <Eigen/SparseCore>

#include <vector>

namespace slipstick::tfeti
{
  /// The largest eigenvalue of a symmetric positive semidefinite matrix, to some percent, by the power method. 0 for
  /// none.
  double largest_eigenvalue(const Eigen::SparseMatrix<double> &matrix);

  /// Orthonormal eigenvectors of all eigenvalues of a symmetric positive semidefinite matrix that are at most @p limit.
  /// A sparse factorisation detects where there are none (Sylvester's law of inertia); a dense solver takes the
  /// connected parts that have some, so that each vector lives on one part. Parts come in the order of their first
  /// entries, vectors in that of their eigenvalues.
  std::vector<Eigen::VectorXd> null_vectors(const Eigen::SparseMatrix<double> &matrix, double limit);
} // namespace slipstick::tfeti
