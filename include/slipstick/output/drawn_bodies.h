// Bodies and obstacles in a drawing of the scene.
#pragma once

#include <slipstick/mechanics/spaces.h>
#include <slipstick/mechanics/surface_facet.h>
#include <slipstick/output/svg.h>

namespace slipstick::output
{
  /// From the scene to the plane of the picture [mm]: in the plane what it is, in space as seen from the front (z), the right (x)
  /// and above (y), without perspective, as scripts/render does.
  template <int dim>
  struct Projection
  {
    dealii::Point<2>     operator()(const dealii::Point<dim> &p) const;
    dealii::Tensor<1, 2> along(const dealii::Tensor<1, dim> &v) const;

    /// How near to the eye a place is, in space [mm].
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

  /// Corners of a boundary part as seen; of an edge with a middle that, too, in the order of a line.
  std::vector<dealii::Point<2>> seen(const mechanics::SurfaceEdge<2> &edge);
  std::vector<dealii::Point<2>> seen(const mechanics::SurfaceFacet &facet);

  /// Cells and outlines (outlines alone where there are many cells); in space the faces towards the eye, those behind
  /// first.
  class DrawnBodies
  {
  public:
    /// Collective.
    DrawnBodies(const mesh::Mesh<2> &mesh, const std::vector<mechanics::SurfaceEdge<2>> &outlines);
    DrawnBodies(const mesh::Mesh<3> &mesh, const std::vector<mechanics::SurfaceFacet> &outlines);

    /// On rank 0.
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

  /// @return was it drawn? Surfaces from files and height functions in space are not.
  bool draw_obstacle(std::ostream &out, const View &view, const scene::Obstacle<2> &obstacle, const double t);
  bool draw_obstacle(std::ostream &out, const View &view, const scene::Obstacle<3> &obstacle, const double t);
} // namespace slipstick::output
