// Pairing of points on two surfaces that face each other.
#pragma once

#include <slipstick/base/box_tree.h>
#include <slipstick/interface/convex_polygon.h>
#include <slipstick/interface/curve_pairing.h>
#include <slipstick/interface/edge_tree.h>

#include <optional>

namespace slipstick::interface
{
  /// A plane in space with its own coordinates.
  struct Plane
  {
    using Tensor = dealii::Tensor<1, 3>;

    /// @param normal of any length.
    Plane(const dealii::Point<3> &origin, const Tensor &normal);

    dealii::Point<2> project(const dealii::Point<3> &x) const
    {
      return {(x - origin) * first, (x - origin) * second};
    }

    dealii::Point<3> origin;
    Tensor           normal, first, second; // unit length, right-handed
  };

  /// A facet projected onto a plane.
  class ProjectedFacet
  {
  public:
    using Facet = mechanics::SurfaceFacet;

    ProjectedFacet(const Facet &facet, const Plane &plane);

    /// The polygon of its corners, counter-clockwise when viewed against the normal; for bent facets with the nodes on
    /// their edges; divided into four by its nodes if it is not convex.
    std::vector<ConvexPolygon> outline() const;

    /// The place on the facet that is projected to @p x: exact for parallelograms and triangles, otherwise by Newton's
    /// method. For x slightly outside a bent facet it lies beyond the edge.
    Facet::Place place_at(const dealii::Point<2> &x) const;

    /// Height of that place above the plane [mm].
    double height_at(const dealii::Point<2> &x) const;

  private:
    /// Projection of the place @p s relative to x, and its derivatives along both local coordinates.
    std::array<dealii::Tensor<1, 2>, 3> linearised(const Facet::Place &s, const dealii::Point<2> &x) const;

    unsigned int                                   n_nodes;
    std::array<dealii::Point<2>, Facet::max_nodes> nodes;       // corners first
    Facet::Shape                                   heights{};   // of the nodes [mm]
    dealii::Tensor<1, 2>                           u, v, twist; // x = corner + s u + t v + s t twist
    bool                                           is_bent;     // false: the formula for x applies
    const Facet                                   *facet;
  };

  /// Pairs slave and master facets along normals that are averaged from both sides at the nodes, as in CurvePairing; on
  /// one slave facet their mean is used.
  class SurfacePairing
  {
  public:
    using Facet  = mechanics::SurfaceFacet;
    using Tensor = dealii::Tensor<1, 3>;

    /// The part where a slave facet and a master facet face each other.
    struct Part
    {
      unsigned int   master; // facet
      ProjectedFacet facet;  // projected
      ConvexPolygon  polygon;
    };

    /// The master facets that face a slave facet within reach, projected along the mean normal of its nodes; parts
    /// overlap if master facets lie one behind the other. Where the distance jumps, as at a step or a slot of the
    /// master, only the nearest level counts (as in CurvePairing).
    struct View
    {
      Plane             plane; // through the centre of the facet
      ProjectedFacet    slave;
      std::vector<Part> parts;

      /// Distance from the slave to the master along the normal [mm].
      double gap(const Part &part, const dealii::Point<2> &x) const
      {
        return part.facet.height_at(x) - slave.height_at(x);
      }

      /// Whether another master facet is nearer at x. Of several at the same distance the first counts.
      bool is_hidden(const Part &part, const dealii::Point<2> &x) const;
    };

    /// The facets are kept by reference.
    SurfacePairing(const std::vector<Facet> &slave,
                   const std::vector<Facet> &master,
                   const Reach              &reach,
                   const Corners            &corners = {});

    const std::vector<SurfaceNode<3>> &nodes() const
    {
      return own.nodes;
    }

    /// The nodes of slave facet e.
    const PartNodes<Facet> &nodes_of(const unsigned int e) const
    {
      return own.of_part[e];
    }

    View view(const unsigned int e) const;

  private:
    void                      average_normals(const Corners &corners);
    std::vector<unsigned int> candidates(const std::vector<dealii::Point<3>> &points,
                                         const Tensor                        &n,
                                         const double                         size) const;

    struct Facing
    {
      Tensor normal; // unit length
      bool   is_at_corner = false;
    };

    /// The master at the point hit by the ray from a slave node, if any.
    std::optional<Facing> facing_normal(const SurfaceNode<3>  &node,
                                        const SurfaceNodes<3> &of_master,
                                        const Corners         &corners) const;

    const std::vector<Facet> &slave, &master;
    const Reach               reach;
    const BoxTree<3>          tree; // of the master
    SurfaceNodes<3>           own;  // of the slave
  };
} // namespace slipstick::interface
