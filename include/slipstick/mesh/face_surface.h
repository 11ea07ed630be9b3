// The smooth surface that a boundary face of a solid stands for.
#pragma once

#include <slipstick/mesh/edge_curve.h>
#include <slipstick/mesh/facet_shapes.h>

#include <type_traits>
#include <vector>

namespace slipstick::mesh
{
  /// Surface over a face: part of a ball or a cylinder, or a patch of degree 2 through the nodes of a mesh of second order. A face
  /// intended to be plane has none.
  struct FaceSurface
  {
    using Point  = dealii::Point<3>;
    using Tensor = dealii::Tensor<1, 3>;
    using Place  = FacetShapes::Place; // local coordinates of a patch

    enum class Kind
    {
      none,
      ball,
      cylinder,
      patch
    };

    Kind         kind    = Kind::none;
    unsigned int n_nodes = 0; // of a patch: 6 or 9
    double       radius  = 0; // of a ball or cylinder [mm]

    /// Of a ball: its centre; of a cylinder: two points of its axis; of a patch: its nodes (FacetShapes) [mm].
    std::array<Point, FacetShapes::max_nodes> points;

    /// Sagitta of a surface that the face may be intended to represent but does not follow [mm].
    double left_out = 0;

    static FaceSurface ball(const Point &center, const double radius);
    static FaceSurface cylinder(const Point &on_axis, const Tensor &axis, const double radius);

    /// @param nodes six or nine.
    static FaceSurface patch(const std::vector<Point> &nodes);

    explicit operator bool() const
    {
      return kind != Kind::none;
    }

    unsigned int n_corners() const
    {
      return n_nodes == 6 ? 3 : 4;
    }

    /// Of a patch.
    Point  point(const Place &s) const;
    Tensor area_vector(const Place &s) const;

    /// The point of a ball or cylinder that is nearest to @p x.
    Point nearest(const Point &x) const;

    /// A quarter of a patch, which continues in the same parameters: at corner @p part, of a triangle that in the middle for 3.
    FaceSurface quarter(const unsigned int part) const;

    /// Distance t with x + t @p direction on the surface (continued a little beyond its edges): @p x is near the surface, @p
    /// direction a unit vector across it. 0 where there is no such point.
    double distance_along(const Point &x, const Tensor &direction) const;

    /// Unit normal at the point of the surface that is seen from @p x along @p outward, on the side that this points to.
    Tensor normal(const Point &x, const Tensor &outward) const;

    template <class F>
    void move(const F &f)
    {
      const unsigned int n = kind == Kind::patch ? n_nodes : kind == Kind::cylinder ? 2 : kind == Kind::ball ? 1 : 0;
      for (unsigned int i = 0; i < n; ++i)
        f(points[i]);
    }

    template <class Archive>
    void serialize(Archive &archive, const unsigned int /*version*/)
    {
      archive &kind &n_nodes &radius &points &left_out;
    }

  private:
    /// Where the line from x along a direction meets a patch, and how far on.
    struct Hit
    {
      Place  place;
      double distance = 0;
      bool   is_found = false;
    };
    Hit hit(const Point &x, const Tensor &direction) const;

    /// Of a patch, along both local coordinates.
    std::array<Tensor, 2> tangents(const Place &s) const;

    /// Of a cylinder, of unit length.
    Tensor axis() const;

    /// The centre of a ball; the point of the axis of a cylinder at the height of @p x.
    Point foot(const Point &x) const;
  };

  /// What the boundary faces of a body stand for.
  template <int dim>
  using BoundaryCurve = std::conditional_t<dim == 2, EdgeCurve<2>, FaceSurface>;
} // namespace slipstick::mesh
