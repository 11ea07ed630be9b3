#include <slipstick/mesh/face_surface.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace slipstick::mesh
{
  namespace
  {
    // Newton's method for the intersection of a patch with a line: maximum number of steps, last step, and admissible
    // distance beyond the patch.
    constexpr unsigned int max_steps = 30;
    constexpr double       last_step = 1e-13, beyond = 1;

    // Corners of the quarters of a triangle; the other nodes are midpoints between them.
    constexpr std::array<std::array<std::array<double, 2>, 3>, 4> quarters_of_triangle = {
      {{{{{0, 0}}, {{.5, 0}}, {{0, .5}}}},
       {{{{.5, 0}}, {{1, 0}}, {{.5, .5}}}},
       {{{{0, .5}}, {{.5, .5}}, {{0, 1}}}},
       {{{{.5, 0}}, {{.5, .5}}, {{0, .5}}}}}};
  } // namespace

  FaceSurface FaceSurface::ball(const Point &center, const double radius)
  {
    FaceSurface surface;
    surface.kind      = Kind::ball;
    surface.radius    = radius;
    surface.points[0] = center;
    return surface;
  }

  FaceSurface FaceSurface::cylinder(const Point &on_axis, const Tensor &axis, const double radius)
  {
    FaceSurface surface;
    surface.kind      = Kind::cylinder;
    surface.radius    = radius;
    surface.points[0] = on_axis;
    surface.points[1] = on_axis + radius / axis.norm() * axis; // at a distance of the radius, to keep digits when moved
    return surface;
  }

  FaceSurface FaceSurface::patch(const std::vector<Point> &nodes)
  {
    FaceSurface surface;
    surface.kind    = Kind::patch;
    surface.n_nodes = nodes.size();
    std::copy(nodes.begin(), nodes.end(), surface.points.begin());
    return surface;
  }

  FaceSurface::Point FaceSurface::point(const Place &s) const
  {
    const auto N = FacetShapes::quadratic(n_corners(), s);
    Point      x;
    for (unsigned int i = 0; i < n_nodes; ++i)
      x += N[i] * Tensor(points[i]);
    return x;
  }

  std::array<FaceSurface::Tensor, 2> FaceSurface::tangents(const Place &s) const
  {
    const auto            dN = FacetShapes::quadratic_derivatives(n_corners(), s);
    std::array<Tensor, 2> along;
    for (unsigned int i = 0; i < n_nodes; ++i)
      for (unsigned int d = 0; d < 2; ++d)
        along[d] += dN[i][d] * Tensor(points[i]);
    return along;
  }

  FaceSurface::Tensor FaceSurface::area_vector(const Place &s) const
  {
    const auto [a, b] = tangents(s);
    return cross_product_3d(a, b);
  }

  FaceSurface::Tensor FaceSurface::axis() const
  {
    return (points[1] - points[0]) / (points[1] - points[0]).norm();
  }

  FaceSurface::Point FaceSurface::foot(const Point &x) const
  {
    return kind == Kind::cylinder ? points[0] + ((x - points[0]) * axis()) * axis() : points[0];
  }

  FaceSurface::Point FaceSurface::nearest(const Point &x) const
  {
    const Point  from = foot(x);
    const Tensor arm  = x - from;
    return from + radius / arm.norm() * arm;
  }

  FaceSurface FaceSurface::quarter(const unsigned int part) const
  {
    const unsigned int n = n_corners();
    std::vector<Point> nodes;
    for (unsigned int i = 0; i < n_nodes; ++i)
      {
        const Place s = FacetShapes::node(n, i);
        Place       at;
        if (n == 4)
          at = Place(0.5 * (FacetShapes::node(4, part) + s));
        else
          {
            const auto L = FacetShapes::linear(3, s);
            for (unsigned int k = 0; k < 3; ++k)
              for (unsigned int d = 0; d < 2; ++d)
                at[d] += L[k] * quarters_of_triangle[part][k][d];
          }
        nodes.push_back(point(at));
      }
    return patch(nodes);
  }

  FaceSurface::Hit FaceSurface::hit(const Point &x, const Tensor &direction) const
  {
    Hit    result;
    double nearest = std::numeric_limits<double>::max();
    for (unsigned int i = 0; i < n_nodes; ++i) // start from the node with the smallest lateral distance
      {
        const Tensor to  = points[i] - x;
        const double off = (to - (to * direction) * direction).norm();
        if (off < nearest)
          {
            nearest         = off;
            result.place    = FacetShapes::node(n_corners(), i);
            result.distance = to * direction;
          }
      }
    for (unsigned int k = 0; k < max_steps; ++k)
      {
        const auto [a, b] = tangents(result.place);
        // a ds + b dt - direction dd = off
        const Tensor off = x + result.distance * direction - point(result.place);
        const Tensor n   = cross_product_3d(a, b);
        const double det = n * direction;
        const Place  step(cross_product_3d(off, b) * direction / det, cross_product_3d(a, off) * direction / det);
        result.place += step;
        result.distance -= n * off / det;
        if (!(step.norm() > last_step))
          {
            result.is_found = std::isfinite(result.distance);
            for (unsigned int d = 0; d < 2; ++d)
              result.is_found = result.is_found && result.place[d] > -beyond && result.place[d] < 1 + beyond;
            return result;
          }
      }
    return result;
  }

  double FaceSurface::distance_along(const Point &x, const Tensor &direction) const
  {
    if (kind == Kind::patch)
      {
        const Hit at = hit(x, direction);
        return at.is_found ? at.distance : 0.;
      }
    if (kind == Kind::none)
      return 0;
    Tensor arm = x - points[0], along = direction;
    if (kind == Kind::cylinder)
      {
        arm -= (arm * axis()) * axis();
        along -= (along * axis()) * axis();
      }
    // |arm + t along| = radius: the root nearest to 0, without cancellation
    const double a = along * along, b = arm * along, c = (arm.norm() - radius) * (arm.norm() + radius);
    const double square = b * b - a * c;
    if (!(square > 0))
      return 0;
    return -c / (b + std::copysign(std::sqrt(square), b));
  }

  FaceSurface::Tensor FaceSurface::normal(const Point &x, const Tensor &outward) const
  {
    const Tensor direction = outward / outward.norm();
    Tensor       n         = outward;
    if (kind == Kind::patch)
      {
        if (const Hit at = hit(x, direction); at.is_found)
          n = area_vector(at.place);
      }
    else if (kind != Kind::none)
      {
        const Point on = x + distance_along(x, direction) * direction;
        n              = on - foot(on);
      }
    return n / (n * outward > 0 ? n.norm() : -n.norm());
  }
} // namespace slipstick::mesh
