#include <slipstick/base/cross.h>
#include <slipstick/interface/convex_polygon.h>

#include <algorithm>
#include <limits>

namespace slipstick::interface
{
  namespace
  {
    // Corners that turn by less than this angle [rad] are ignored.
    constexpr double straight = 1e-9;

    const dealii::Point<2> &next(const ConvexPolygon &polygon, const std::size_t i)
    {
      return polygon[(i + 1) % polygon.size()];
    }
  } // namespace

  double area(const ConvexPolygon &polygon)
  {
    double sum = 0;
    for (std::size_t i = 1; i + 1 < polygon.size(); ++i)
      sum += cross(polygon[i] - polygon[0], polygon[i + 1] - polygon[0]) / 2;
    return sum;
  }

  double area(const std::vector<ConvexPolygon> &polygons)
  {
    double sum = 0;
    for (const auto &polygon : polygons)
      sum += area(polygon);
    return sum;
  }

  dealii::Point<2> centroid(const ConvexPolygon &polygon)
  {
    dealii::Tensor<1, 2> moment, corners;
    double               sum = 0;
    for (std::size_t i = 0; i < polygon.size(); ++i)
      {
        const auto   u = polygon[i] - polygon[0], v = next(polygon, i) - polygon[0];
        const double part = cross(u, v) / 2;
        sum += part;
        moment += part / 3 * (u + v);
        corners += u / double(polygon.size());
      }
    return polygon[0] + (sum > 0 ? moment / sum : corners);
  }

  bool is_convex(const ConvexPolygon &polygon)
  {
    for (std::size_t i = 0; i < polygon.size(); ++i)
      {
        const auto &y    = next(polygon, i);
        const auto  from = y - polygon[i], to = next(polygon, i + 1) - y;
        if (cross(from, to) < -straight * from.norm() * to.norm())
          return false;
      }
    return true;
  }

  bool contains(const ConvexPolygon &polygon, const dealii::Point<2> &x, const double tolerance)
  {
    for (std::size_t i = 0; i < polygon.size(); ++i)
      if (const auto along = next(polygon, i) - polygon[i]; cross(along, x - polygon[i]) < -tolerance * along.norm())
        return false;
    return !polygon.empty();
  }

  dealii::Point<2> nearest_point(const ConvexPolygon &polygon, const dealii::Point<2> &x)
  {
    if (contains(polygon, x))
      return x;
    double           least = std::numeric_limits<double>::max();
    dealii::Point<2> nearest;
    for (std::size_t i = 0; i < polygon.size(); ++i)
      {
        const auto   along  = next(polygon, i) - polygon[i];
        const double square = along.norm_square();
        const double t      = square > 0 ? std::clamp(along * (x - polygon[i]) / square, 0., 1.) : 0.;
        const auto   there  = polygon[i] + t * along;
        if (const double apart = x.distance(there); apart < least)
          {
            least   = apart;
            nearest = there;
          }
      }
    return nearest;
  }

  double distance(const ConvexPolygon &polygon, const dealii::Point<2> &x)
  {
    return x.distance(nearest_point(polygon, x));
  }

  ConvexPolygon intersection(const ConvexPolygon &a, const ConvexPolygon &b)
  {
    ConvexPolygon left = a;
    for (std::size_t i = 0; i < b.size() && !left.empty(); ++i)
      {
        const auto    along = next(b, i) - b[i];
        ConvexPolygon kept;
        for (std::size_t k = 0; k < left.size(); ++k)
          {
            const auto  &x = left[k], &y = next(left, k);
            const double inside_x = cross(along, x - b[i]), inside_y = cross(along, y - b[i]);
            if (inside_x >= 0)
              kept.push_back(x);
            if ((inside_x > 0 && inside_y < 0) || (inside_x < 0 && inside_y > 0))
              kept.push_back(x + inside_x / (inside_x - inside_y) * (y - x));
          }
        left = std::move(kept);
      }
    return left;
  }
} // namespace slipstick::interface
