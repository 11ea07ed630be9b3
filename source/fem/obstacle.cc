#include <slipstick/base/exceptions.h>
#include <slipstick/fem/obstacle.h>

namespace slipstick::fem
{
  template <int dim>
  ObstacleContact<dim> contact_with(const scene::Obstacle<dim> &obstacle, const dealii::Point<dim> &x)
  {
    const dealii::Tensor<1, dim> ray      = obstacle.center - x;
    const double                 distance = ray.norm();
    if (!(distance > 0))
      throw InputError("a contact node lies at the centre of obstacle " + obstacle.name + ", where it has no normal",
                       "move the obstacle, or give the contact another slave boundary");
    return {ray / distance, distance - obstacle.radius};
  }

  template ObstacleContact<2> contact_with(const scene::Obstacle<2> &, const dealii::Point<2> &);
} // namespace slipstick::fem
