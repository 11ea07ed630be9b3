// The cross product in the plane.
#pragma once

#include <deal.II/base/tensor.h>

namespace slipstick
{
  /// The out-of-plane component of a x b: positive if b is to the left of a.
  inline double cross(const dealii::Tensor<1, 2> &a, const dealii::Tensor<1, 2> &b)
  {
    return a[0] * b[1] - a[1] * b[0];
  }
} // namespace slipstick
