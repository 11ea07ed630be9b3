// The nodes of a curve or surface in contact, and their averaged normals.
#pragma once

#include <slipstick/mechanics/surface_facet.h>

#include <tuple>

namespace slipstick::interface
{
  /// A node; a node at a corner or an edge of the surface appears once for each side.
  template <int dim>
  struct SurfaceNode
  {
    mechanics::NodeKey     key{};
    unsigned int           side = 0;
    dealii::Point<dim>     position;    // [mm]
    dealii::Tensor<1, dim> normal;      // outward, unit length
    double                 size    = 0; // largest size of the edges or facets there [mm]
    double                 covered = 0; // integral of the shape function over these [mm], in space [mm^2]
    double                 measure = 0; // the same with the measure of the kinematics
    double                 scale   = 0; // the measure of the edges or facets there
  };

  /// Outward unit normal of the true curve or surface at node i of an edge or facet.
  inline dealii::Tensor<1, 2> outline_normal_at(const mechanics::SurfaceEdge<2> &edge, const unsigned int i)
  {
    return edge.outline_normal(mechanics::SurfaceEdge<2>::node_coordinate(i));
  }

  inline dealii::Tensor<1, 3> outline_normal_at(const mechanics::SurfaceFacet &facet, const unsigned int i)
  {
    return facet.outline_normal(i);
  }

  /// The numbers of the nodes of an edge or facet.
  template <class Part>
  using PartNodes = std::array<unsigned int, std::tuple_size<decltype(Part::keys)>::value>;

  /// The nodes of a surface in the order of their keys, and the nodes of every edge or facet.
  template <int dim>
  struct SurfaceNodes
  {
    using Part   = mechanics::BoundaryPart<dim>;
    using Tensor = dealii::Tensor<1, dim>;

    explicit SurfaceNodes(const std::vector<Part> &surface, const mesh::Kinematics<dim> &kinematics = {});

    /// Normals at the nodes of part e, interpolated with the shape functions N there; not of unit length.
    template <class Shape>
    Tensor normal(const unsigned int e, const unsigned int n_nodes, const Shape &N) const
    {
      Tensor n;
      for (unsigned int i = 0; i < n_nodes; ++i)
        n += N[i] * nodes[of_part[e][i]].normal;
      return n;
    }

    std::vector<SurfaceNode<dim>> nodes;
    std::vector<PartNodes<Part>>  of_part;

  private:
    using Places = std::vector<std::pair<unsigned int, unsigned int>>; // part, node of the part

    void add(const std::vector<Part> &surface, const Places &places, const mechanics::NodeKey &key);
  };
} // namespace slipstick::interface
