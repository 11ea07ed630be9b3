// Bodies and obstacles in a picture of the scene.
#pragma once

#include <slipstick/mechanics/spaces.h>
#include <slipstick/mechanics/surface_facet.h>
#include <slipstick/output/svg.h>

namespace slipstick::output
{
  /// Projection from the scene to the picture plane [mm]: the identity in the plane; in space a parallel projection
  /// from the front (z), the right (x) and above (y), as in scripts/render.
  template <int dim>
  struct Projection
  {
    dealii::Point<2>     operator()(const dealii::Point<dim> &p) const;
    dealii::Tensor<1, 2> along(const dealii::Tensor<1, dim> &v) const;

    /// Depth coordinate towards the viewer, in space [mm].
    double nearness(const dealii::Point<dim> &p) const;
  };

  template <>
  dealii::Point<2> Projection<2>::operator()(const dealii::Point<2> &p) const;
  template <>
  dealii::Point<2> Projection<3>::operator()(const dealii::Point<3> &p) const;
  template <>
  dealii::Tensor<1, 2> Projection<2>::along(const dealii::Tensor<1, 2> &v) const;
  template <>
  dealii::Tensor<1, 2> Projection<3>::along(const dealii::Tensor<1, 3> &v) const;
  template <>
  double Projection<3>::nearness(const dealii::Point<3> &p) const;

  /// Projected corners of a boundary part; for an edge with a mid node also that node, in the order along the edge.
  std::vector<dealii::Point<2>> seen(const mechanics::SurfaceEdge<2> &edge);
  std::vector<dealii::Point<2>> seen(const mechanics::SurfaceFacet &facet);

  /// Cells and outlines (only outlines for large meshes); in space the faces towards the viewer, sorted from back to
  /// front.
  class DrawnBodies
  {
  public:
    /// Collective.
    DrawnBodies(const mesh::Mesh<2> &mesh, const std::vector<mechanics::SurfaceEdge<2>> &outlines);
    DrawnBodies(const mesh::Mesh<3> &mesh, const std::vector<mechanics::SurfaceFacet> &outlines);

    /// Called on rank 0.
    void write(std::ostream &out, const View &view) const;

  private:
    struct Polygon
    {
      std::vector<dealii::Point<2>> corners;
      std::string                   colour;
    };
    std::vector<Polygon>                       faces;        // in space
    std::vector<std::vector<dealii::Point<2>>> cells, edges; // in the plane
  };

  /// Draws an obstacle. @return whether it was drawn; surfaces from files and height functions in space are not.
  bool draw_obstacle(std::ostream &out, const View &view, const scene::Obstacle<2> &obstacle, const double t);
  bool draw_obstacle(std::ostream &out, const View &view, const scene::Obstacle<3> &obstacle, const double t);
} // namespace slipstick::output
