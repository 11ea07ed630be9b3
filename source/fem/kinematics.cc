#include <slipstick/fem/kinematics.h>

namespace slipstick::fem
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

  template <int dim>
  dealii::Quadrature<dim> Kinematics<dim>::stiffness_rule(const Element<dim> &element) const
  {
    if (is_revolved && element.cell.is_simplex() && element.degree == 1)
      return element.cell_quadrature(2);
    return element.stiffness;
  }

  template class Kinematics<2>;
} // namespace slipstick::fem
