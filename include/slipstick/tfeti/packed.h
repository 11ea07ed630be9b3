// Dense symmetric matrices: stored as packed lower triangles, and made from Cholesky factors.
#pragma once

#include <slipstick/tfeti/options.h>

#include <Eigen/Dense>

#include <vector>

namespace slipstick::tfeti
{
  /// Lower triangle, column by column.
  std::vector<double> packed_lower(const Eigen::MatrixXd &matrix);

  /// The same of the rows and columns @p order[0], @p order[1], ...
  std::vector<double> packed_lower(const Eigen::MatrixXd &matrix, const std::vector<unsigned int> &order);

  /// The full matrix.
  Eigen::MatrixXd unpacked(const std::vector<double> &lower);

  /// L L' or its inverse from a lower triangular L; full, symmetric to the last bit. By BLAS and LAPACK.
  Eigen::MatrixXd product_of_factor(const Eigen::MatrixXd &L);
  Eigen::MatrixXd inverse_of_product(Eigen::MatrixXd L);

  /// A symmetric matrix with n rows, n (n + 1) / 2 numbers, stored in double or single precision.
  class PackedSymmetric
  {
  public:
    PackedSymmetric(std::vector<double> lower, const Precision precision);

    /// y = A x with the stored A, in double.
    void multiply(const Eigen::VectorXd &x, Eigen::VectorXd &y) const;

    std::size_t bytes() const
    {
      return in_double.size() * sizeof(double) + in_single.size() * sizeof(float);
    }

  private:
    std::vector<double> in_double; // one of them is empty
    std::vector<float>  in_single;
  };
} // namespace slipstick::tfeti
