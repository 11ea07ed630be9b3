// The smooth surface represented by a boundary face of a solid.
#pragma once

#include <slipstick/mesh/edge_curve.h>
#include <slipstick/mesh/facet_shapes.h>

#include <type_traits>
#include <vector>

namespace slipstick::mesh
{
  /// Surface over a face: part of a ball or a cylinder, or a patch of degree 2 through the nodes of a second-order
  /// mesh. Faces intended to be plane have no surface.
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

    /// Ball: its centre; cylinder: two points of its axis; patch: its nodes (FacetShapes) [mm].
    std::array<Point, FacetShapes::max_nodes> points;

    /// Sagitta of a surface that the face probably represents but does not follow [mm].
    double neglected_sagitta = 0;

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

    /// Point and area vector of a patch.
    Point  point(const Place &s) const;
    Tensor area_vector(const Place &s) const;

    /// The point of a ball or cylinder that is nearest to @p x.
    Point nearest(const Point &x) const;

    /// A quarter of a patch with its own local coordinates: at corner @p part; 3: the central quarter of a triangle.
    FaceSurface quarter(const unsigned int part) const;

    /// Distance t with x + t @p direction on the surface (extended slightly beyond its edges). @p x must be near the
    /// surface, @p direction is a unit vector transverse to it. 0 if there is no such point.
    double distance_along(const Point &x, const Tensor &direction) const;

    /// Unit normal at the intersection of the surface with the line from @p x along @p outward, on the side of @p
    /// outward.
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
      archive &kind &n_nodes &radius &points &neglected_sagitta;
    }

  private:
    /// Intersection of the line from x along a direction with a patch, and its distance.
    struct Hit
    {
      Place  place;
      double distance = 0;
      bool   is_found = false;
    };
    Hit hit(const Point &x, const Tensor &direction) const;

    /// Derivatives of a patch with respect to both local coordinates.
    std::array<Tensor, 2> tangents(const Place &s) const;

    /// Unit vector of the axis of a cylinder.
    Tensor axis() const;

    /// The centre of a ball; the point on the axis of a cylinder nearest to @p x.
    Point foot(const Point &x) const;
  };

  /// The curve or surface represented by a boundary face of a body.
  template <int dim>
  using BoundaryCurve = std::conditional_t<dim == 2, EdgeCurve<2>, FaceSurface>;
} // namespace slipstick::mesh
