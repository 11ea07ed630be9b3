// Symmetric matrices stored as packed lower triangles, column by column.
#pragma once

#include <Eigen/Dense>

#include <vector>

namespace slipstick::tfeti
{
  std::vector<double> packed_lower(const Eigen::MatrixXd &matrix);

  /// y = A x; half the memory traffic of a full matrix (BLAS dspmv).
  void multiply_packed(const std::vector<double> &matrix, const Eigen::VectorXd &x, Eigen::VectorXd &y);
} // namespace slipstick::tfeti
