#include <slipstick/base/cross.h>
#include <slipstick/mesh/edge_curve.h>

#include <algorithm>
#include <cmath>

namespace slipstick::mesh
{
  namespace
  {
    // Newton's method for the intersection of a cubic with a line: converges quadratically from a start that is one
    // sagitta away; the intersection is at most this fraction of the edge beyond an end.
    constexpr unsigned int most_steps   = 20;
    constexpr double       small_step   = 1e-15;
    constexpr double       continuation = 0.5;

    /// Weights of the rays to both ends in the ray to the point at s of an arc, and their derivatives.
    template <int dim>
    std::array<double, 4> shares(const EdgeCurve<dim> &arc, const double s)
    {
      const auto   from = arc.points[0] - arc.points[2], to = arc.points[1] - arc.points[2];
      const double angle = std::acos(std::clamp(from * to / (from.norm() * to.norm()), -1., 1.));
      return {{std::sin((1 - s) * angle) / std::sin(angle),
               std::sin(s * angle) / std::sin(angle),
               -angle * std::cos((1 - s) * angle) / std::sin(angle),
               angle * std::cos(s * angle) / std::sin(angle)}};
    }
  } // namespace

  template <int dim>
  EdgeCurve<dim> EdgeCurve<dim>::arc(const Point &start, const Point &end, const Point &center)
  {
    EdgeCurve curve;
    curve.kind   = Kind::arc;
    curve.points = {{start, end, center, center}};
    return curve;
  }

  template <int dim>
  EdgeCurve<dim> EdgeCurve<dim>::parabola(const Point &start, const Point &middle, const Point &end)
  {
    return hermite(start, 4 * (middle - start) - (end - start), 4 * (end - middle) - (end - start), end);
  }

  template <int dim>
  EdgeCurve<dim> EdgeCurve<dim>::hermite(const Point &start, const Tensor &from, const Tensor &to, const Point &end)
  {
    EdgeCurve curve;
    curve.kind   = Kind::cubic;
    curve.points = {{start, start + from / 3, end - to / 3, end}};
    return curve;
  }

  template <int dim>
  dealii::Point<dim> EdgeCurve<dim>::point(const double s) const
  {
    if (kind == Kind::arc)
      {
        const auto share = shares(*this, s);
        return points[2] + share[0] * (points[0] - points[2]) + share[1] * (points[1] - points[2]);
      }
    const double r = 1 - s;
    return points[0] + 3 * r * r * s * (points[1] - points[0]) + 3 * r * s * s * (points[2] - points[0]) +
           s * s * s * (points[3] - points[0]);
  }

  template <int dim>
  dealii::Tensor<1, dim> EdgeCurve<dim>::tangent(const double s) const
  {
    if (kind == Kind::arc)
      {
        const auto share = shares(*this, s);
        return share[2] * (points[0] - points[2]) + share[3] * (points[1] - points[2]);
      }
    const double r = 1 - s;
    return 3 * r * r * (points[1] - points[0]) + 6 * r * s * (points[2] - points[1]) +
           3 * s * s * (points[3] - points[2]);
  }

  template <int dim>
  EdgeCurve<dim> EdgeCurve<dim>::part(const double from, const double to) const
  {
    if (kind == Kind::none)
      return *this;
    if (kind == Kind::arc)
      return arc(point(from), point(to), points[2]);
    return hermite(point(from), (to - from) * tangent(from), (to - from) * tangent(to), point(to));
  }

  template <int dim>
  EdgeCurve<dim> EdgeCurve<dim>::reversed() const
  {
    EdgeCurve curve = *this;
    if (kind == Kind::arc)
      std::swap(curve.points[0], curve.points[1]);
    else
      std::reverse(curve.points.begin(), curve.points.end());
    return curve;
  }

  template <int dim>
  double EdgeCurve<dim>::distance_along(const Point &x, const Tensor &direction, const double s) const
  {
    if (kind == Kind::none)
      return 0;
    if (kind == Kind::arc)
      {
        // root of t^2 + 2 t b + c = 0 with the smaller magnitude
        const auto   ray    = x - points[2];
        const double radius = points[2].distance(points[0]);
        const double b = ray * direction, c = (ray.norm() - radius) * (ray.norm() + radius), square = b * b - c;
        if (!(square >= 0) || b == 0)
          return 0;
        return -c / (b + std::copysign(std::sqrt(square), b));
      }
    double r = s;
    for (unsigned int i = 0; i < most_steps; ++i)
      {
        const double slope = cross(direction, tangent(r));
        if (slope == 0)
          return 0;
        const double step = cross(direction, point(r) - x) / slope;
        r                 = std::clamp(r - step, -continuation, 1 + continuation);
        if (std::abs(step) <= small_step)
          break;
      }
    return direction * (point(r) - x);
  }

  template <int dim>
  double sagitta(const EdgeCurve<dim> &curve)
  {
    if (!curve)
      return 0;
    const auto start = curve.point(0), end = curve.point(1);
    return std::abs(cross(curve.point(0.5) - start, end - start)) / (end - start).norm();
  }

  template struct EdgeCurve<2>;
  template double sagitta(const EdgeCurve<2> &);
} // namespace slipstick::mesh
