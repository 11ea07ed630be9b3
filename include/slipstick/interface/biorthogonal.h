// Functions biorthogonal to the shape functions of an edge or facet (Wohlmuth 2000).
#pragma once

#include <Eigen/Dense>

namespace slipstick::interface
{
  /// A measure of the linear independence of functions T: the least eigenvalue of their mass matrix <T T'> scaled to a
  /// diagonal of 1.
  double independence(const Eigen::MatrixXd &mass);

  /// A in phi = A T such that <phi_i T_k> is <T_i> for i = k and 0 otherwise: diag(<T>) <T T'>^-1.
  /// @param mass <T T'>. @param measures <T>.
  Eigen::MatrixXd biorthogonal(const Eigen::MatrixXd &mass, const Eigen::VectorXd &measures);
} // namespace slipstick::interface
