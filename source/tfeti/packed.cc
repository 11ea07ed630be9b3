#include <slipstick/tfeti/packed.h>

extern "C" void dspmv_(const char   *uplo,
                       const int    *n,
                       const double *alpha,
                       const double *ap,
                       const double *x,
                       const int    *incx,
                       const double *beta,
                       double       *y,
                       const int    *incy);

namespace slipstick::tfeti
{
  std::vector<double> packed_lower(const Eigen::MatrixXd &matrix)
  {
    std::vector<double> packed;
    packed.reserve(matrix.rows() * (matrix.rows() + 1) / 2);
    for (Eigen::Index j = 0; j < matrix.cols(); ++j)
      packed.insert(packed.end(), matrix.col(j).data() + j, matrix.col(j).data() + matrix.rows());
    return packed;
  }

  void multiply_packed(const std::vector<double> &matrix, const Eigen::VectorXd &x, Eigen::VectorXd &y)
  {
    const int    n = x.size(), one = 1;
    const double alpha = 1, beta = 0;
    y.resize(n);
    if (n > 0)
      dspmv_("L", &n, &alpha, matrix.data(), x.data(), &one, &beta, y.data(), &one);
  }
} // namespace slipstick::tfeti
