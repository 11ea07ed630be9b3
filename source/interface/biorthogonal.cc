#include <slipstick/interface/biorthogonal.h>
#include <slipstick/tfeti/dense.h>

namespace slipstick::interface
{
  namespace
  {
    // On a small part of an edge the entries differ by orders of magnitude.
    Eigen::VectorXd scale_of(const Eigen::MatrixXd &mass)
    {
      return mass.diagonal().cwiseSqrt().cwiseInverse();
    }
  } // namespace

  double independence(const Eigen::MatrixXd &mass)
  {
    const Eigen::VectorXd scale = scale_of(mass);
    return tfeti::symmetric_eigenvalues(scale.asDiagonal() * mass * scale.asDiagonal())[0];
  }

  Eigen::MatrixXd biorthogonal(const Eigen::MatrixXd &mass, const Eigen::VectorXd &measures)
  {
    const Eigen::VectorXd scale  = scale_of(mass);
    const Eigen::MatrixXd scaled = scale.asDiagonal() * mass * scale.asDiagonal();
    return measures.asDiagonal() * (scale.asDiagonal() * scaled.inverse() * scale.asDiagonal()).eval();
  }
} // namespace slipstick::interface
