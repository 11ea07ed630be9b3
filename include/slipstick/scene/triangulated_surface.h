// A rigid surface made of triangles, as CAD programs export it.
#pragma once

#include <slipstick/base/box_tree.h>

#include <array>
#include <string>
#include <vector>

namespace slipstick::scene
{
  /// A closed surface; its triangles run counter-clockwise as seen from the side where bodies are.
  class TriangulatedSurface
  {
  public:
    using Triangle = std::array<unsigned int, 3>; // vertices

    struct Nearest
    {
      dealii::Tensor<1, 3> normal;       // from the surface to where bodies are, along the distance; unit length
      double               distance = 0; // [mm], negative on the other side
    };

    /// @param corners of triangles, three of each; equal ones are one vertex, and triangles with two equal corners are
    /// left out. @param name for messages.
    /// @throws InputError for a surface that is empty, not closed, or whose triangles do not run the same way.
    TriangulatedSurface(const std::string &name, const std::vector<dealii::Point<3>> &corners);

    /// From the nearest point of the surface. On which side @p x lies there is decided by the mean of the normals around
    /// an edge or, weighted by their angles, a vertex (Baerentzen, Aanaes 2005).
    Nearest nearest(const dealii::Point<3> &x) const;

    /// Diagonal of the box around it [mm].
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
    /// At a vertex or an edge no farther than @p distance from the foot that of all triangles there.
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
