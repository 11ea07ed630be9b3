#include <slipstick/mesh/kinematics.h>

namespace slipstick::mesh
{
  template <int dim>
  dealii::Tensor<1, dim> Kinematics<dim>::arm(const dealii::Point<dim>     &x,
                                              const dealii::Point<dim>     &axis,
                                              const dealii::Tensor<1, dim> &direction) const
  {
    dealii::Tensor<1, dim> r = x - axis;
    if (dim == 3 && direction.norm() > 0)
      r -= (r * direction) / direction.norm_square() * direction;
    else if (dim == 3) // about the line along z
      r[dim - 1] = 0;
    if (is_revolved)
      r[1] = 0;
    return r;
  }

  template class Kinematics<2>;
  template class Kinematics<3>;
} // namespace slipstick::mesh
