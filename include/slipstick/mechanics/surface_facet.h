// Boundary faces of solids as independent surfaces: nodes, shape functions, normals.
#pragma once

#include <slipstick/base/box_tree.h>
#include <slipstick/mechanics/surface.h>

#include <boost/serialization/array.hpp>

#include <type_traits>

namespace slipstick::mechanics
{
  /// A face on the surface of a solid: a triangle with local coordinates in the unit triangle (3 or 6 nodes), or a
  /// quadrilateral with local coordinates in the unit square (4 or 9 nodes). Corners are counter-clockwise as seen from
  /// outside, starting with the smallest key; they are followed by the midpoints of the edges that start at the
  /// corners, then by the centre of a quadrilateral.
  struct SurfaceFacet
  {
    static constexpr unsigned int max_nodes = mesh::FacetShapes::max_nodes;

    using Place  = mesh::FacetShapes::Place; // local coordinates
    using Shape  = mesh::FacetShapes::Shape;
    using Tensor = dealii::Tensor<1, 3>;

    unsigned int                                 body      = 0;
    unsigned int                                 boundary  = 0; // boundary id
    unsigned int                                 subdomain = 0;
    unsigned int                                 n_nodes   = 4;
    std::array<NodeKey, max_nodes>               keys{};
    std::array<std::array<double, 3>, max_nodes> at{};    // [mm]
    mesh::FaceSurface                            surface; // true surface; none: the facet itself

    template <class Archive>
    void serialize(Archive &archive, const unsigned int /*version*/)
    {
      archive &body &boundary &subdomain &n_nodes &keys &at &surface;
    }

    unsigned int n_corners() const
    {
      return n_nodes == 3 || n_nodes == 6 ? 3 : 4;
    }

    /// Whether the facet is of degree 2.
    bool is_quadratic() const
    {
      return n_nodes > n_corners();
    }

    /// Whether the facet is of degree 2 with nodes off the bilinear surface of its corners.
    bool is_bent() const;

    dealii::Point<3> node(const unsigned int i) const
    {
      return dealii::Point<3>(at[i][0], at[i][1], at[i][2]);
    }

    /// Shape functions of the nodes; 0 for missing nodes.
    Shape shape(const Place &s) const;

    /// Shape functions of degree 1 of the corners.
    Shape shape_of_corners(const Place &s) const;

    dealii::Point<3> point(const Place &s) const;

    /// Outward normal whose length is the area per area of the local coordinates [mm^2].
    Tensor area_vector(const Place &s) const;

    /// Outward unit normal.
    Tensor normal(const Place &s) const
    {
      const Tensor a = area_vector(s);
      return a / a.norm();
    }

    Tensor normal_at(const unsigned int i) const
    {
      return normal(node_coordinate(i));
    }

    /// Outward unit normal of the true surface at node i.
    Tensor outline_normal(const unsigned int i) const
    {
      const Tensor own = normal_at(i);
      return surface ? surface.normal(node(i), own) : own;
    }

    /// Height of the true surface above the facet at s along @p direction, a unit vector transverse to both [mm].
    double rise(const Place &s, const Tensor &direction) const
    {
      return surface ? surface.distance_along(point(s), direction) : 0.;
    }

    Place node_coordinate(const unsigned int i) const
    {
      return mesh::FacetShapes::node(n_corners(), i);
    }

    Place middle_place() const
    {
      return mesh::FacetShapes::middle(n_corners());
    }

    dealii::Point<3> middle() const
    {
      return point(middle_place());
    }

    /// Mean length of the edges [mm].
    double chord() const;

    /// Distance from the triangle of the corners, or the two of a quadrilateral [mm].
    double distance(const dealii::Point<3> &x) const;

    /// Integral of the shape function of every node over the facet [mm^2]: lengths and measures in space. It is 0 at
    /// the corners of a triangle of degree 2: equal pressure exerts no force on them.
    Shape tributary_areas() const;
    Shape tributary_lengths() const
    {
      return tributary_areas();
    }
    Shape tributary_measures(const mesh::Kinematics<3> &) const
    {
      return tributary_areas();
    }

    /// Order of the facets of all bodies that does not depend on the decomposition.
    bool operator<(const SurfaceFacet &other) const
    {
      return std::tie(body, keys) < std::tie(other.body, other.keys);
    }
  };

  /// Type of the parts of a body's boundary.
  template <int dim>
  using BoundaryPart = std::conditional_t<dim == 2, SurfaceEdge<2>, SurfaceFacet>;

  /// The part of the surface that corresponds to face @p face of @p cell.
  inline SurfaceEdge<2> surface_part(const mesh::SubdomainMesh<2>                      &subdomain,
                                     const Spaces<2>                                   &spaces,
                                     const dealii::DoFHandler<2>::active_cell_iterator &cell,
                                     const unsigned int                                 face)
  {
    return surface_edge(subdomain, spaces, cell, face);
  }
  SurfaceFacet surface_part(const mesh::SubdomainMesh<3>                      &subdomain,
                            const Spaces<3>                                   &spaces,
                            const dealii::DoFHandler<3>::active_cell_iterator &cell,
                            const unsigned int                                 face);

  /// Outward unit normals.
  inline dealii::Tensor<1, 2> middle_normal(const SurfaceEdge<2> &edge)
  {
    return edge.normal(0.5);
  }
  inline dealii::Tensor<1, 3> middle_normal(const SurfaceFacet &facet)
  {
    return facet.normal(facet.middle_place());
  }
  /// Sampling points between the nodes.
  std::vector<dealii::Point<2>> inner_points(const SurfaceEdge<2> &edge);
  std::vector<dealii::Point<3>> inner_points(const SurfaceFacet &facet);

  /// Tree of the bounding boxes of facets.
  BoxTree<3> facet_tree(const std::vector<SurfaceFacet> &facets);

  /// The facets of the surfaces of bodies (by index: whether wanted), sorted, the same on every rank. Collective.
  std::vector<SurfaceFacet> outlines(const mesh::Mesh<3>     &mesh,
                                     const Spaces<3>         &spaces,
                                     const std::vector<bool> &wanted);

  /// The parts on one boundary, in their order.
  template <int dim, class Part>
  std::vector<Part> parts_on(const mesh::Mesh<dim>     &mesh,
                             const std::vector<Part>   &parts,
                             const scene::BoundaryName &where)
  {
    std::vector<Part> found;
    for (const auto &part : parts)
      if (part.body == where.body && mesh.on_boundary(where, part.boundary))
        found.push_back(part);
    return found;
  }
} // namespace slipstick::mechanics
