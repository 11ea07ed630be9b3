// Displacements of rotations.
#pragma once

#include <deal.II/base/tensor.h>

#include <array>

namespace slipstick
{
  /// 1 in the plane, 3 in space.
  template <int dim>
  constexpr unsigned int n_rotations = dim *(dim - 1) / 2;

  /// The displacements of a point at @p r from the centre under a unit rotation: in the plane, or about each axis in space.
  template <int dim>
  std::array<dealii::Tensor<1, dim>, n_rotations<dim>> turned(const dealii::Tensor<1, dim> &r)
  {
    std::array<dealii::Tensor<1, dim>, n_rotations<dim>> result;
    for (unsigned int k = 0; k < n_rotations<dim>; ++k)
      {
        const unsigned int a = dim == 2 ? 0 : (k + 1) % 3, b = dim == 2 ? 1 : (k + 2) % 3; // rotates a towards b
        result[k][a] = -r[b];
        result[k][b] = r[a];
      }
    return result;
  }
} // namespace slipstick
