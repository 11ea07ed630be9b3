#include <slipstick/mesh/kinematics.h>

namespace slipstick::mesh
{
  template <int dim>
  dealii::Tensor<1, dim> Kinematics<dim>::arm(const dealii::Point<dim> &x, const dealii::Point<dim> &axis) const
  {
    static_assert(dim == 2, "the axis of revolution is y");
    dealii::Tensor<1, dim> r = x - axis;
    if (is_revolved)
      r[1] = 0;
    return r;
  }

  template class Kinematics<2>;
} // namespace slipstick::mesh
