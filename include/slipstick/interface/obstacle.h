// Distance to a rigid obstacle without a mesh.
#pragma once

#include <slipstick/scene/scene.h>

namespace slipstick::interface
{
  template <int dim>
  struct ObstacleContact
  {
    dealii::Tensor<1, dim> normal; // from the node towards the obstacle, unit length
    double                 gap;    // along the normal [mm], negative inside
  };

  /// Distance of @p x to @p obstacle at load factor @p t. Circle and hole: along the ray through the centre. Polyline:
  /// to its nearest point; its first and last segments are extended unless it is closed (ends at its start); at a
  /// convex corner the normal points from the node to the corner. Function: to the nearest point of y = h(x, t), or, if
  /// the search for it does not converge, to the tangent at the point above or below. Triangulated surface: to its
  /// nearest point.
  /// @throws InputError for a node exactly at the centre of a circle or hole.
  template <int dim>
  ObstacleContact<dim> contact_with(const scene::Obstacle<dim> &obstacle, const dealii::Point<dim> &x, const double t);
} // namespace slipstick::interface
