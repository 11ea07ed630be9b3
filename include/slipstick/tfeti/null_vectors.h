// Null vectors of a sparse positive semidefinite matrix. Nearly always there are none, which is detected at low
// cost.
#pragma once

#include <Eigen/Core>
#include <Eigen/SparseCore>

#include <vector>

namespace slipstick::tfeti
{
  /// The largest eigenvalue of a symmetric positive semidefinite matrix to a few percent, by the power method. 0 for an
  /// empty matrix.
  double largest_eigenvalue(const Eigen::SparseMatrix<double> &matrix);

  /// Orthonormal eigenvectors of all eigenvalues of a symmetric positive semidefinite matrix that are at most @p limit.
  /// A sparse factorisation detects connected parts without such eigenvalues (Sylvester's law of inertia); a dense
  /// solver handles the others, so that each vector is nonzero on one part only. Parts are ordered by their first
  /// entries, the vectors of a part by their eigenvalues.
  std::vector<Eigen::VectorXd> null_vectors(const Eigen::SparseMatrix<double> &matrix, double limit);
} // namespace slipstick::tfeti
