// The smooth curve represented by a boundary edge of a mesh.
#pragma once

#include <deal.II/base/point.h>

#include <boost/serialization/array.hpp>

#include <array>

namespace slipstick::mesh
{
  /// Curve over an edge, parameter s in [0, 1]: a circular arc or a cubic. Edges intended to be straight have no curve.
  template <int dim>
  struct EdgeCurve
  {
    using Point  = dealii::Point<dim>;
    using Tensor = dealii::Tensor<1, dim>;

    enum class Kind
    {
      none,
      arc,
      cubic
    };

    Kind kind = Kind::none;

    /// Arc: start, end, centre; cubic: its Bezier points [mm].
    std::array<Point, 4> points;

    /// Sagitta of a curve that the edge probably represents but does not follow [mm].
    double neglected_sagitta = 0;

    static EdgeCurve arc(const Point &start, const Point &end, const Point &center);

    /// The parabola through three points, the second at s = 1/2.
    static EdgeCurve parabola(const Point &start, const Point &middle, const Point &end);

    /// @param from, to derivatives with respect to s at the ends.
    static EdgeCurve hermite(const Point &start, const Tensor &from, const Tensor &to, const Point &end);

    explicit operator bool() const
    {
      return kind != Kind::none;
    }

    Point  point(const double s) const;
    Tensor tangent(const double s) const; // d point / d s

    /// The part between two parameters; the same curve in the opposite direction.
    EdgeCurve part(const double from, const double to) const;
    EdgeCurve reversed() const;

    /// Distance t with x + t @p direction on the curve (extended slightly beyond its ends). @p x must be near the
    /// curve, about opposite its point at @p s; @p direction is a unit vector transverse to it. 0 if there is no such
    /// point.
    double distance_along(const Point &x, const Tensor &direction, const double s) const;

    template <class F>
    void move(const F &f)
    {
      if (kind != Kind::none)
        for (auto &x : points)
          f(x);
    }

    template <class Archive>
    void serialize(Archive &archive, const unsigned int /*version*/)
    {
      archive &kind &points &neglected_sagitta;
    }
  };

  /// Height of the middle of a curve over its chord [mm].
  template <int dim>
  double sagitta(const EdgeCurve<dim> &curve);
} // namespace slipstick::mesh
