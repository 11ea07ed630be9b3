// A rigid surface made of triangles, as exported by CAD programs.
#pragma once

#include <slipstick/base/box_tree.h>

#include <array>
#include <string>
#include <vector>

namespace slipstick::scene
{
  /// A closed surface; its triangles are counter-clockwise as seen from the side of the bodies.
  class TriangulatedSurface
  {
  public:
    using Triangle = std::array<unsigned int, 3>; // vertices

    struct Nearest
    {
      dealii::Tensor<1, 3> normal;       // from the surface to the side of the bodies, along the distance; unit length
      double               distance = 0; // [mm], negative on the other side
    };

    /// @param corners of triangles, three per triangle; equal corners are merged, and triangles with two equal corners
    /// are ignored. @param name for messages.
    /// @throws InputError for a surface that is empty, not closed, or whose triangles are not oriented consistently.
    TriangulatedSurface(const std::string &name, const std::vector<dealii::Point<3>> &corners);

    /// Distance and normal from the nearest point of the surface. The side on which @p x lies is determined by the mean
    /// of the normals at an edge or, weighted by their angles, at a vertex (Baerentzen, Aanaes 2005).
    Nearest nearest(const dealii::Point<3> &x) const;

    /// Diagonal of the bounding box [mm].
    double extent() const
    {
      return size;
    }

    /// All vertices.
    const std::vector<dealii::Point<3>> &corners() const
    {
      return vertices;
    }

    std::size_t n_triangles() const
    {
      return triangles.size();
    }

  private:
    struct Foot;

    void check_closed(const std::string &name);
    void find_normals();
    Foot foot_on(const unsigned int triangle, const dealii::Point<3> &x) const;
    /// Normal at the foot; if the foot is within @p distance of a vertex or an edge, the mean over all triangles there.
    dealii::Tensor<1, 3> normal_around(const Foot &foot, const double distance) const;
    dealii::Point<3>     corner(const unsigned int triangle, const unsigned int k) const;

    std::vector<dealii::Point<3>>            vertices;
    std::vector<Triangle>                    triangles;
    std::vector<std::array<unsigned int, 3>> neighbours;                         // across the edges k, k + 1
    std::vector<dealii::Tensor<1, 3>> normals_of_triangles, normals_of_vertices; // unit length; 0 if there is none
    double                            size = 0;
    BoxTree<3>                        tree;
  };
} // namespace slipstick::scene
