// Dense symmetric matrices: packed storage of the lower triangle, and assembly from Cholesky factors.
#pragma once

#include <slipstick/tfeti/options.h>

#include <deal.II/base/aligned_vector.h>

#include <Eigen/Dense>

#include <vector>

namespace slipstick::tfeti
{
  /// L L' or its inverse for a lower triangular L; full matrix, exactly symmetric. Uses BLAS and LAPACK.
  Eigen::MatrixXd product_of_factor(const Eigen::MatrixXd &L);
  Eigen::MatrixXd inverse_of_product(Eigen::MatrixXd L);

  /// A symmetric matrix with n rows, stored in double or single precision, lower triangle only. Storage: panels of 4
  /// columns from the diagonal down, in each panel blocks of 8 rows, so that a product passes once through the matrix,
  /// and through the vectors a quarter as often as column by column. Padding of the panels with zeros costs about 8 /
  /// n.
  class PackedSymmetric
  {
  public:
    /// Rows and columns @p order[0], @p order[1], ... of a full symmetric @p matrix.
    PackedSymmetric(const Eigen::MatrixXd &matrix, const std::vector<unsigned int> &order, const Precision precision);

    /// y = A x with the stored A, in double precision.
    void multiply(const Eigen::VectorXd &x, Eigen::VectorXd &y) const;

    /// The full matrix with the stored values.
    Eigen::MatrixXd full() const;

    unsigned int n_rows() const
    {
      return n;
    }

    std::size_t bytes() const
    {
      return in_double.size() * sizeof(double) + in_single.size() * sizeof(float);
    }

  private:
    unsigned int                  n;
    dealii::AlignedVector<double> in_double; // one of the two is empty
    dealii::AlignedVector<float>  in_single;
  };
} // namespace slipstick::tfeti
