#include <slipstick/base/exceptions.h>
#include <slipstick/interface/obstacle.h>
#include <slipstick/scene/triangulated_surface.h>

#include <cmath>
#include <limits>

namespace slipstick::interface
{
  namespace
  {
    using Point  = dealii::Point<2>;
    using Tensor = dealii::Tensor<1, 2>;

    Tensor unit(const double x, const double y)
    {
      Tensor v;
      v[0] = x;
      v[1] = y;
      return v / v.norm();
    }

    /// Distance to a circle, a ball or (for the ray perpendicular to its axis) a cylinder.
    template <int dim>
    ObstacleContact<dim> with_circle(const scene::Obstacle<dim> &obstacle, const dealii::Tensor<1, dim> &ray)
    {
      const double distance = ray.norm();
      if (!(distance > 0))
        throw InputError("a contact node lies at the centre of obstacle " + obstacle.name + ", where it has no normal",
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

    ObstacleContact<2> with_function(const scene::Field<2> &height, const Point &x, const double t)
    {
      const auto h     = [&](const double at) { return height.value(Point(at, x[1]), t); };
      const auto slope = [&](const double at) {
        const double step = 1e-5 * std::max(1., std::abs(at)); // error of the slope about 1e-10
        return (h(at + step) - h(at - step)) / (2 * step);
      };
      const auto onto_tangent = [&](const double at) -> ObstacleContact<2> {
        const Tensor normal = unit(slope(at), -1);
        return {normal, (Point(at, h(at)) - x) * normal};
      };
      double foot = x[0];
      for (unsigned int i = 0; i < 100; ++i)
        {
          const double m    = slope(foot);
          const double next = foot + ((x[0] - foot) + (x[1] - h(foot)) * m) / (1 + m * m);
          const double step = std::abs(next - foot);
          foot              = next;
          if (step <= 1e-10 * std::max(1., std::abs(foot)))
            return onto_tangent(foot);
        }
      return onto_tangent(x[0]);
    }

    /// The same in space: y = h(x, z).
    ObstacleContact<3> with_function(const scene::Field<3> &height, const dealii::Point<3> &x, const double t)
    {
      using Vector            = dealii::Tensor<1, 3>; // in the plane of x and z
      const auto h            = [&](const Vector &at) { return height.value(dealii::Point<3>(at[0], x[1], at[2]), t); };
      const auto onto_tangent = [&](const Vector &at) {
        Vector normal;
        for (const unsigned int d : {0, 2})
          {
            const double step = 1e-5 * std::max(1., std::abs(at[d])); // error of the slope about 1e-10
            Vector       way;
            way[d]    = step;
            normal[d] = (h(at + way) - h(at - way)) / (2 * step);
          }
        normal[1] = -1;
        normal /= normal.norm();
        return ObstacleContact<3>{normal, (dealii::Point<3>(at[0], h(at), at[2]) - x) * normal};
      };
      Vector above = x;
      above[1]     = 0;
      Vector foot  = above;
      for (unsigned int i = 0; i < 100; ++i)
        {
          const auto contact = onto_tangent(foot);
          Vector     next    = x + contact.gap * contact.normal; // nearest point of the tangential plane
          next[1]            = 0;
          const double step  = (next - foot).norm();
          foot               = next;
          if (step <= 1e-10 * std::max(1., foot.norm()))
            return onto_tangent(foot);
        }
      return onto_tangent(above);
    }
  } // namespace

  template <>
  ObstacleContact<2> contact_with(const scene::Obstacle<2> &obstacle, const dealii::Point<2> &x, const double t)
  {
    switch (obstacle.shape)
      {
        case scene::ObstacleShape::circle:
        case scene::ObstacleShape::hole:
          return with_circle<2>(obstacle, obstacle.center - x);
        case scene::ObstacleShape::half_plane:
          return {-obstacle.normal, (x - obstacle.center) * obstacle.normal};
        case scene::ObstacleShape::polyline:
          return with_polyline(obstacle.points, x);
        case scene::ObstacleShape::function:
          return with_function(obstacle.height, x, t);
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
          return with_circle<3>(obstacle, ray);
        case scene::ObstacleShape::half_plane:
          return {-obstacle.normal, -ray * obstacle.normal};
        case scene::ObstacleShape::cylinder:
        case scene::ObstacleShape::bore:
          return with_circle<3>(obstacle, ray - (ray * obstacle.normal) * obstacle.normal);
        case scene::ObstacleShape::function:
          return with_function(obstacle.height, x, t);
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
