// Unit vectors perpendicular to a direction.
#pragma once

#include <deal.II/base/tensor.h>

#include <array>
#include <cmath>

namespace slipstick
{
  /// Unit vectors perpendicular to a unit vector and to each other: in the plane the one to its left; in space the
  /// first is nearest to the axis most perpendicular to the unit vector.
  template <int dim>
  std::array<dealii::Tensor<1, dim>, dim - 1> across(const dealii::Tensor<1, dim> &direction)
  {
    std::array<dealii::Tensor<1, dim>, dim - 1> result;
    if constexpr (dim == 2)
      {
        result[0][0] = -direction[1];
        result[0][1] = direction[0];
      }
    else
      {
        unsigned int axis = 0;
        for (unsigned int d = 1; d < dim; ++d)
          if (std::abs(direction[d]) < std::abs(direction[axis]))
            axis = d;
        result[0][axis] = 1;
        result[0] -= direction[axis] * direction;
        result[0] /= result[0].norm();
        result[1] = cross_product_3d(direction, result[0]);
      }
    return result;
  }
} // namespace slipstick
