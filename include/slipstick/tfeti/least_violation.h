// Systems of linear inequalities: the point that violates them least.
#pragma once

#include <Eigen/Core>

namespace slipstick::tfeti
{
  /// An a that minimises the sum of squares of the negative entries of values + rates a; if there are several, one
  /// close to 0. Newton's method from 0 with exact line searches, which converges from any start: the sum is convex,
  /// and its slope is piecewise linear. Full steps are not enough: in a narrow wedge they satisfy the conditions of its
  /// two sides in turn.
  /// @param values of n conditions, satisfied where not negative.
  /// @param rates n x m.
  Eigen::VectorXd least_violation(const Eigen::VectorXd &values, const Eigen::MatrixXd &rates);
} // namespace slipstick::tfeti
