// Which points of two surfaces face each other.
#pragma once

#include <slipstick/interface/box_tree.h>
#include <slipstick/interface/convex_polygon.h>
#include <slipstick/interface/curve_pairing.h>
#include <slipstick/interface/edge_tree.h>
#include <slipstick/mechanics/surface_facet.h>

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

    /// Corners of the projected facet, counter-clockwise as seen from outside.
    ConvexPolygon project(const mechanics::SurfaceFacet &facet) const;

    /// The place on a facet whose projection is @p x: exact for parallelograms and triangles, else by Newton's method.
    dealii::Point<2> place_on(const mechanics::SurfaceFacet &facet, const dealii::Point<2> &x) const;

    dealii::Point<3> origin;
    Tensor           normal, first, second; // unit length, right-handed
  };

  /// Boxes around facets.
  BoxTree<3> facet_tree(const std::vector<mechanics::SurfaceFacet> &facets);

  template <>
  class ClosedSurface<mechanics::SurfaceFacet>
  {
  public:
    /// @param facets are not copied.
    explicit ClosedSurface(const std::vector<mechanics::SurfaceFacet> &facets)
      : facets(facets)
    {}

    /// Is x inside? By the solid angle of the surface (van Oosterom, Strackee 1983).
    bool contains(const dealii::Point<3> &x) const;

  private:
    const std::vector<mechanics::SurfaceFacet> &facets;
  };

  /// Slave and master facets, joined along normals that are at the nodes the means of both sides, as in CurvePairing; over
  /// one slave facet their mean.
  class SurfacePairing
  {
  public:
    using Facet  = mechanics::SurfaceFacet;
    using Tensor = dealii::Tensor<1, 3>;

    /// A slave node; a node on an edge or a corner of the slave boundary appears once for each side.
    struct Node
    {
      mechanics::NodeKey key{};
      unsigned int       side = 0;
      dealii::Point<3>   position;    // [mm]
      Tensor             normal;      // outward, unit length
      double             covered = 0; // integral of the shape function over the facets there [mm^2]
      double             size    = 0; // of these facets, the largest [mm]
    };

    /// Where a slave facet and a master facet face each other.
    struct Part
    {
      unsigned int  master = 0; // facet
      ConvexPolygon polygon;    // on the plane of the slave facet
    };

    /// The facets are not copied.
    SurfacePairing(const std::vector<Facet> &slave, const std::vector<Facet> &master, const Reach &reach);

    const std::vector<Node> &nodes() const
    {
      return all_nodes;
    }

    /// The nodes of slave facet e.
    const std::array<unsigned int, Facet::max_nodes> &nodes_of(const unsigned int e) const
    {
      return node_of[e];
    }

    /// The plane on which slave facet e is paired.
    Plane plane(const unsigned int e) const;

    /// What faces slave facet e within reach; parts overlap where master facets lie one behind the other.
    std::vector<Part> parts(const unsigned int e) const;

    /// From slave facet e to master facet m, along the normal of the plane at its point x [mm].
    double gap(const unsigned int e, const unsigned int m, const Plane &plane, const dealii::Point<2> &x) const;

  private:
    void                      average_normals();
    std::vector<unsigned int> candidates(const std::vector<dealii::Point<3>> &points,
                                         const Tensor                        &n,
                                         const double                         size) const;

    /// Unit normal of the master that the ray from a slave node meets, if any.
    std::optional<Tensor> facing_normal(
      const Node                                                    &node,
      const std::vector<Node>                                       &of_master,
      const std::vector<std::array<unsigned int, Facet::max_nodes>> &nodes_of_master) const;

    const std::vector<Facet>                               &slave, &master;
    const Reach                                             reach;
    const BoxTree<3>                                        tree; // of the master
    std::vector<Node>                                       all_nodes;
    std::vector<std::array<unsigned int, Facet::max_nodes>> node_of; // by slave facet
  };
} // namespace slipstick::interface
