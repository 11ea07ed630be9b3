#include <slipstick/base/exceptions.h>
#include <slipstick/base/text.h>
#include <slipstick/interface/obstacle.h>
#include <slipstick/scene/triangulated_surface.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace slipstick::interface
{
  namespace
  {
    using Point  = dealii::Point<2>;
    using Tensor = dealii::Tensor<1, 2>;

    // Size of the features of height functions that count [mm]; for smaller bodies it is that of the bodies.
    constexpr double size_of_features = 1;
    // Steps of the differences that give the slope of a height function, as a part of this size or of the coordinate,
    // whichever is larger: the error of the slope is about 1e-10.
    constexpr double slope_step = 1e-5;
    // The search for the nearest point of a height function ends when it moves by less than this part of these lengths;
    // the gap is then exact to rounding, since its error is quadratic.
    constexpr double foot_tolerance = 1e-10;
    // It converges linearly, and slowly where the radius of curvature is not much larger than the distance.
    constexpr unsigned int most_foot_points = 100;

    Tensor unit(const double x, const double y)
    {
      Tensor v;
      v[0] = x;
      v[1] = y;
      return v / v.norm();
    }

    /// Distance to a circle, a ball or (for the ray perpendicular to its axis) a cylinder.
    template <int dim>
    ObstacleContact<dim> with_circle(const scene::Obstacle<dim>   &obstacle,
                                     const dealii::Point<dim>     &x,
                                     const dealii::Tensor<1, dim> &ray)
    {
      const double distance = ray.norm();
      if (!(distance > 0))
        throw InputError("the contact node at " + point_text(x, dim) + " lies at the centre of obstacle " +
                           obstacle.name + ", where it has no normal",
                         "move the obstacle, or give the contact another slave boundary");
      if (obstacle.shape == scene::ObstacleShape::hole || obstacle.shape == scene::ObstacleShape::bore)
        return {-ray / distance, obstacle.radius - distance};
      return {ray / distance, distance - obstacle.radius};
    }

    ObstacleContact<2> with_polyline(const std::vector<Point> &points, const Point &x)
    {
      const unsigned int n         = points.size() - 1; // segments
      const bool         is_closed = n > 2 && points.front().distance(points.back()) == 0;
      const auto         left      = [&](const unsigned int k) { // normal of segment k on the side of the bodies
        const Tensor along = points[k + 1] - points[k];
        return unit(-along[1], along[0]);
      };
      double       best = std::numeric_limits<double>::max();
      unsigned int k    = 0;
      double       s    = 0;
      for (unsigned int i = 0; i < n; ++i)
        {
          const Tensor along = points[i + 1] - points[i];
          double       at    = (x - points[i]) * along / along.norm_square();
          if (i > 0 || is_closed)
            at = std::max(at, 0.);
          if (i + 1 < n || is_closed)
            at = std::min(at, 1.);
          const double distance = x.distance(points[i] + at * along);
          if (distance < best)
            {
              best = distance;
              k    = i;
              s    = at;
            }
        }
      const bool is_start = s == 0 && (k > 0 || is_closed), is_end = s == 1 && (k + 1 < n || is_closed);
      if (!is_start && !is_end)
        return {-left(k), (x - points[k]) * left(k)};
      // at a corner: the nearest point is the same for both segments
      const Tensor both = left(k) + left(is_start ? (k + n - 1) % n : (k + 1) % n);
      const Tensor ray  = x - points[is_start ? k : k + 1];
      if (ray.norm() == 0)
        return {-unit(both[0], both[1]), 0.};
      const double sign = ray * both >= 0 ? 1. : -1.;
      return {-sign * ray / ray.norm(), sign * ray.norm()};
    }

    /// The length to which steps are relative, at a coordinate or a distance from the origin.
    template <int dim>
    double scale(const scene::Obstacle<dim> &obstacle, const double coordinate)
    {
      return std::max(std::min(size_of_features, obstacle.extent), std::abs(coordinate));
    }

    /// @p foot: approximation of the nearest point of the surface y = h(x) or y = h(x, z); its height is not used.
    template <int dim>
    ObstacleContact<dim> with_tangent(const scene::Obstacle<dim> &obstacle,
                                      const dealii::Point<dim>   &foot,
                                      const dealii::Point<dim>   &x,
                                      const double                t)
    {
      const auto             h = [&](const dealii::Point<dim> &at) { return obstacle.height.value(at, t); };
      dealii::Tensor<1, dim> normal;
      for (unsigned int d = 0; d < dim; ++d)
        if (d != 1)
          {
            dealii::Tensor<1, dim> step;
            step[d]   = slope_step * scale(obstacle, foot[d]);
            normal[d] = (h(foot + step) - h(foot - step)) / (2 * step[d]);
          }
      normal[1] = -1;
      normal /= normal.norm();
      auto on_surface = foot;
      on_surface[1]   = h(foot);
      return {normal, (on_surface - x) * normal};
    }

    template <int dim>
    ObstacleContact<dim> with_function(const scene::Obstacle<dim> &obstacle,
                                       const dealii::Point<dim>   &x,
                                       const double                t)
    {
      auto foot = x;
      for (unsigned int i = 0; i < most_foot_points; ++i)
        {
          const auto contact = with_tangent(obstacle, foot, x, t);
          auto       next    = x + contact.gap * contact.normal; // nearest point of the tangent
          next[1]            = x[1];
          const double step  = next.distance(foot);
          foot               = next;
          const double away  = dim == 2 ? foot[0] : std::hypot(foot[0], foot[dim - 1]);
          if (step <= foot_tolerance * scale(obstacle, away))
            return with_tangent(obstacle, foot, x, t);
        }
      return with_tangent(obstacle, x, x, t);
    }
  } // namespace

  template <>
  ObstacleContact<2> contact_with(const scene::Obstacle<2> &obstacle, const dealii::Point<2> &x, const double t)
  {
    switch (obstacle.shape)
      {
        case scene::ObstacleShape::circle:
        case scene::ObstacleShape::hole:
          return with_circle(obstacle, x, obstacle.center - x);
        case scene::ObstacleShape::half_plane:
          return {-obstacle.normal, (x - obstacle.center) * obstacle.normal};
        case scene::ObstacleShape::polyline:
          return with_polyline(obstacle.points, x);
        case scene::ObstacleShape::function:
          return with_function(obstacle, x, t);
        case scene::ObstacleShape::cylinder: // not available in 2D
        case scene::ObstacleShape::bore:
        case scene::ObstacleShape::stl:
          break;
      }
    AssertThrow(false, dealii::ExcInternalError());
    return {};
  }

  template <>
  ObstacleContact<3> contact_with(const scene::Obstacle<3> &obstacle, const dealii::Point<3> &x, const double t)
  {
    const dealii::Tensor<1, 3> ray = obstacle.center - x;
    switch (obstacle.shape)
      {
        case scene::ObstacleShape::circle:
        case scene::ObstacleShape::hole:
          return with_circle(obstacle, x, ray);
        case scene::ObstacleShape::half_plane:
          return {-obstacle.normal, -ray * obstacle.normal};
        case scene::ObstacleShape::cylinder:
        case scene::ObstacleShape::bore:
          return with_circle(obstacle, x, ray - (ray * obstacle.normal) * obstacle.normal);
        case scene::ObstacleShape::function:
          return with_function(obstacle, x, t);
        case scene::ObstacleShape::stl:
          {
            const auto there = obstacle.surface->nearest(x);
            return {-there.normal, there.distance};
          }
        case scene::ObstacleShape::polyline: // not available in space
          break;
      }
    AssertThrow(false, dealii::ExcInternalError());
    return {};
  }
} // namespace slipstick::interface
