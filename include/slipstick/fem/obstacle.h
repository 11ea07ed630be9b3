// Distance to a rigid obstacle that needs no mesh.
#pragma once

#include <slipstick/scene/scene.h>

namespace slipstick::fem
{
  template <int dim>
  struct ObstacleContact
  {
    dealii::Tensor<1, dim> normal; // from the node towards the obstacle, unit length
    double                 gap;    // along the normal [mm], negative inside
  };

  /// Distance of @p x to @p obstacle along the ray to its centre. @throws InputError for a node at the very centre.
  template <int dim>
  ObstacleContact<dim> contact_with(const scene::Obstacle<dim> &obstacle, const dealii::Point<dim> &x);
} // namespace slipstick::fem
