// Points of the semismooth Newton method with their gradients and products.
#pragma once

#include <utility>

namespace slipstick::qp::detail
{
  /// A point with its gradient F x - d + G'a; both are linear along a step.
  template <typename Vector>
  struct PointWithGradient
  {
    Vector x, gradient;
  };

  /// The same with F x, so that points between two of them cost no multiplication.
  template <typename Vector>
  struct NewtonPoint : PointWithGradient<Vector>
  {
    NewtonPoint(Vector x_, Vector gradient_, Vector Fx_)
      : PointWithGradient<Vector>{std::move(x_), std::move(gradient_)}
      , Fx(std::move(Fx_))
    {}

    Vector Fx;
    double error_of_Fx = 0; // by rounding, weighted, estimated
  };
} // namespace slipstick::qp::detail
