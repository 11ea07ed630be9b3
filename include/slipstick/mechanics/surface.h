// Boundary edges of bodies as independent curves: nodes, shape functions, normals.
#pragma once

#include <slipstick/base/cross.h>
#include <slipstick/mechanics/spaces.h>
#include <slipstick/mesh/kinematics.h>

#include <boost/serialization/array.hpp>

namespace slipstick::mechanics
{
  /// An edge on the outline of a body, straight with two nodes or curved with three; local coordinate s in [0, 1]. The
  /// body is on the left when going from node 0 (s = 0) to node 1 (s = 1); node 2 is in the middle.
  template <int dim>
  struct SurfaceEdge
  {
    unsigned int                           body      = 0;
    unsigned int                           boundary  = 0; // boundary id
    unsigned int                           subdomain = 0;
    unsigned int                           n_nodes   = 2;
    std::array<NodeKey, 3>                 keys{};
    std::array<std::array<double, dim>, 3> at{};  // [mm]
    mesh::EdgeCurve<dim>                   curve; // true curve, from node 0 to node 1; none: the edge itself

    template <class Archive>
    void serialize(Archive &archive, const unsigned int /*version*/)
    {
      archive &body &boundary &subdomain &n_nodes &keys &at &curve;
    }

    static constexpr unsigned int n_corners()
    {
      return 2;
    }

    dealii::Point<dim> node(const unsigned int i) const
    {
      return dealii::Point<dim>(at[i][0], at[i][1]);
    }

    /// Shape functions of the nodes at s (0 for a missing third node), and their derivatives.
    std::array<double, 3> shape(const double s) const;
    std::array<double, 3> shape_derivative(const double s) const;

    dealii::Point<dim> point(const double s) const;
    dealii::Point<dim> middle() const
    {
      return point(0.5);
    }
    dealii::Tensor<1, dim> tangent(const double s) const; // d point / d s
    dealii::Tensor<1, dim> normal(const double s) const;  // outward, unit length

    /// Normal at node i.
    dealii::Tensor<1, dim> normal_at(const unsigned int i) const
    {
      return normal(node_coordinate(i));
    }

    /// Outward unit normal of the true curve.
    dealii::Tensor<1, dim> outline_normal(const double s) const;

    /// Height of the true curve above the edge at s along @p direction, a unit vector transverse to both [mm].
    double rise(const double s, const dealii::Tensor<1, dim> &direction) const
    {
      return curve ? curve.distance_along(point(s), direction, s) : 0.;
    }

    /// Local coordinate of node i: 0, 1, 1/2.
    static double node_coordinate(const unsigned int i)
    {
      return i == 2 ? 0.5 : i;
    }

    /// Distance of the end points [mm].
    double chord() const
    {
      return node(0).distance(node(1));
    }

    /// Integral of the shape function of every node over the edge [mm]; all positive.
    std::array<double, 3> tributary_lengths() const
    {
      return tributary_measures(mesh::Kinematics<dim>());
    }

    /// The same with the measure of the kinematics [mm], [mm^2]; 0 for the end node of a quadratic edge that is on the
    /// axis of revolution.
    std::array<double, 3> tributary_measures(const mesh::Kinematics<dim> &kinematics) const;

    /// Order of the edges of all bodies that does not depend on the decomposition.
    bool operator<(const SurfaceEdge &other) const
    {
      return std::tie(body, keys) < std::tie(other.body, other.keys);
    }
  };

  /// The edge of face @p face of @p cell.
  template <int dim>
  SurfaceEdge<dim> surface_edge(const mesh::SubdomainMesh<dim>                               &subdomain,
                                const Spaces<dim>                                            &spaces,
                                const typename dealii::DoFHandler<dim>::active_cell_iterator &cell,
                                const unsigned int                                            face);


  /// The edges of the outlines of bodies (by index: whether wanted), sorted, the same on every rank. Collective.
  template <int dim>
  std::vector<SurfaceEdge<dim>> outlines(const mesh::Mesh<dim>   &mesh,
                                         const Spaces<dim>       &spaces,
                                         const std::vector<bool> &wanted);

  /// The edges on one boundary, in their order.
  template <int dim>
  std::vector<SurfaceEdge<dim>> edges_on(const mesh::Mesh<dim>               &mesh,
                                         const std::vector<SurfaceEdge<dim>> &outlines,
                                         const scene::BoundaryName           &where);

  // Edges that meet at a node at a larger angle form a corner: no common normal.
  constexpr double corner_cosine = 0.7; // slightly more than 45 degrees

  /// Smoothed unit normals of edges that meet at a node: those that form no corner with the first of their group are
  /// averaged. @return group of every normal. @param means returns the unit normal of every group.
  template <int dim>
  std::vector<unsigned int> smooth_normals(const std::vector<dealii::Tensor<1, dim>> &normals,
                                           std::vector<dealii::Tensor<1, dim>>       &means);
} // namespace slipstick::mechanics
