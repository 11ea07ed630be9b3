// Which points of two surfaces face each other.
#pragma once

#include <slipstick/base/box_tree.h>
#include <slipstick/interface/convex_polygon.h>
#include <slipstick/interface/curve_pairing.h>
#include <slipstick/interface/edge_tree.h>

#include <optional>

namespace slipstick::interface
{
  /// A plane in space with coordinates of its own.
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

  /// A facet as it is seen along the normal of a plane.
  class ProjectedFacet
  {
  public:
    using Facet = mechanics::SurfaceFacet;

    ProjectedFacet(const Facet &facet, const Plane &plane);

    /// The polygon of its corners, counter-clockwise as seen against the normal, of bent facets with the nodes on their edges; cut
    /// in four by its nodes where that is not convex.
    std::vector<ConvexPolygon> outline() const;

    /// The place on the facet that is seen at @p x: exact for parallelograms and triangles, else by Newton's method. Just outside of
    /// bent facets it is beyond the edge.
    Facet::Place place_at(const dealii::Point<2> &x) const;

    /// How high above the plane that place is [mm].
    double height_at(const dealii::Point<2> &x) const;

  private:
    /// Where the map of the facet has @p s, from x, and its derivatives along both local coordinates.
    std::array<dealii::Tensor<1, 2>, 3> linearised(const Facet::Place &s, const dealii::Point<2> &x) const;

    unsigned int                                   n_nodes;
    std::array<dealii::Point<2>, Facet::max_nodes> nodes;       // corners first
    Facet::Shape                                   heights{};   // of the nodes [mm]
    dealii::Tensor<1, 2>                           u, v, twist; // x = corner + s u + t v + s t twist
    bool                                           is_bent;     // else that holds
    const Facet                                   *facet;
  };

  /// Slave and master facets, joined along normals that are at the nodes the means of both sides, as in CurvePairing; over
  /// one slave facet their mean.
  class SurfacePairing
  {
  public:
    using Facet  = mechanics::SurfaceFacet;
    using Tensor = dealii::Tensor<1, 3>;

    /// Where a slave facet and a master facet face each other.
    struct Part
    {
      unsigned int   master; // facet
      ProjectedFacet facet;  // the same as it is seen
      ConvexPolygon  polygon;
    };

    /// What faces a slave facet within reach, seen along the mean normal of its nodes; parts overlap where master facets lie
    /// one behind the other.
    struct View
    {
      Plane             plane; // through the middle of the facet
      ProjectedFacet    slave;
      std::vector<Part> parts;

      /// From the slave to the master along the normal [mm].
      double gap(const Part &part, const dealii::Point<2> &x) const
      {
        return part.facet.height_at(x) - slave.height_at(x);
      }
    };

    /// The facets are not copied.
    SurfacePairing(const std::vector<Facet> &slave, const std::vector<Facet> &master, const Reach &reach);

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
    void                      average_normals();
    std::vector<unsigned int> candidates(const std::vector<dealii::Point<3>> &points,
                                         const Tensor                        &n,
                                         const double                         size) const;

    /// Unit normal of the master that the ray from a slave node meets, if any.
    std::optional<Tensor> facing_normal(const SurfaceNode<3> &node, const SurfaceNodes<3> &of_master) const;

    const std::vector<Facet> &slave, &master;
    const Reach               reach;
    const BoxTree<3>          tree; // of the master
    SurfaceNodes<3>           own;  // of the slave
  };
} // namespace slipstick::interface
