#include <slipstick/tfeti/dense.h>

namespace slipstick::tfeti
{
  SymmetricEigen::SymmetricEigen(const Eigen::MatrixXd &matrix)
  {
    const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(matrix);
    values  = eigen.eigenvalues();
    vectors = eigen.eigenvectors();
  }

  Eigen::VectorXd symmetric_eigenvalues(const Eigen::MatrixXd &matrix)
  {
    return Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(matrix, Eigen::EigenvaluesOnly).eigenvalues();
  }

  Eigen::VectorXd shortest_solution(const Eigen::MatrixXd &A, const Eigen::VectorXd &b, const double rounding)
  {
    Eigen::CompleteOrthogonalDecomposition<Eigen::MatrixXd> decomposed;
    decomposed.setThreshold(rounding);
    decomposed.compute(A);
    return decomposed.solve(b);
  }

  Eigen::VectorXd basic_solution(const Eigen::MatrixXd &A, const Eigen::VectorXd &b)
  {
    return A.colPivHouseholderQr().solve(b);
  }
} // namespace slipstick::tfeti
