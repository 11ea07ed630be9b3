// Convex polygons in a plane: clipping and integration.
#pragma once

#include <deal.II/base/point.h>
#include <deal.II/base/quadrature.h>

#include <vector>

namespace slipstick::interface
{
  /// Corners in counter-clockwise order.
  using ConvexPolygon = std::vector<dealii::Point<2>>;

  /// Area; negative for clockwise corners.
  double area(const ConvexPolygon &polygon);

  /// Total area.
  double area(const std::vector<ConvexPolygon> &polygons);

  /// Centroid of the area; mean of the corners if the area is zero.
  dealii::Point<2> centroid(const ConvexPolygon &polygon);

  /// Whether no corner is re-entrant.
  bool is_convex(const ConvexPolygon &polygon);

  /// Whether x is inside, or outside by at most @p tolerance.
  bool contains(const ConvexPolygon &polygon, const dealii::Point<2> &x, const double tolerance = 0);

  /// The point of the polygon that is nearest to x; x inside.
  dealii::Point<2> nearest_point(const ConvexPolygon &polygon, const dealii::Point<2> &x);

  /// Distance of x from the polygon; 0 inside.
  double distance(const ConvexPolygon &polygon, const dealii::Point<2> &x);

  /// Intersection of two polygons (Sutherland, Hodgman 1974); empty or of zero area when they only touch.
  ConvexPolygon intersection(const ConvexPolygon &a, const ConvexPolygon &b);

  /// Calls f(point, weight) for the points of @p rule, a rule on the unit triangle, on every triangle formed by the
  /// centroid and an edge; a triangle is not subdivided.
  template <class F>
  void integrate(const ConvexPolygon &polygon, const dealii::Quadrature<2> &rule, const F &f)
  {
    const auto on_triangle = [&](const auto &a, const auto &b, const auto &c) {
      const auto   u = b - a, v = c - a;
      const double twice = u[0] * v[1] - u[1] * v[0];
      for (unsigned int q = 0; q < rule.size(); ++q)
        f(a + rule.point(q)[0] * u + rule.point(q)[1] * v, rule.weight(q) * twice);
    };
    if (polygon.size() == 3)
      return on_triangle(polygon[0], polygon[1], polygon[2]);
    const auto middle = centroid(polygon);
    for (std::size_t i = 0; i < polygon.size(); ++i)
      on_triangle(middle, polygon[i], polygon[(i + 1) % polygon.size()]);
  }
} // namespace slipstick::interface
