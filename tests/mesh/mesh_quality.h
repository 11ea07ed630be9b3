// Measures of a mesh as plain lists.
#pragma once

#include <slipstick/mesh/mesh_piece.h>

#include <cmath>

namespace slipstick::test
{
  struct Quality
  {
    double      area           = 0;
    double      least_angle    = 180; // [degrees]
    double      greatest_angle = 0;
    std::size_t n_triangles    = 0;
    std::size_t n_open_faces   = 0;    // with one cell
    bool        conforming     = true; // no face has more than two cells, boundary faces are exactly the open ones
    double      least_edge     = 1e300;
  };

  inline Quality quality_of(const mesh::MeshPiece<2> &piece)
  {
    Quality quality;
    for (const auto &cell : piece.cells)
      {
        const unsigned int n = mesh::n_corners<2>(cell);
        const auto         x = [&](const unsigned int k) { return piece.vertices[mesh::corner<2>(cell, k)]; };
        quality.n_triangles += n == 3;
        for (unsigned int k = 0; k < n; ++k)
          {
            const auto   a = x(k + 1) - x(k), b = x(k + n - 1) - x(k);
            const double cross = a[0] * b[1] - a[1] * b[0], angle = std::atan2(cross, a * b) * 180 / M_PI;
            quality.least_angle    = std::min(quality.least_angle, angle);
            quality.greatest_angle = std::max(quality.greatest_angle, angle < 0 ? angle + 360 : angle);
            quality.least_edge     = std::min(quality.least_edge, a.norm());
            quality.area += .5 * (x(k)[0] * x(k + 1)[1] - x(k)[1] * x(k + 1)[0]);
          }
      }
    const auto ids   = mesh::ids_of_faces(piece);
    const auto faces = mesh::faces_with_cells(piece);
    for (std::size_t first = 0, last; first < faces.size(); first = last)
      {
        for (last = first; last < faces.size() && faces[last].first == faces[first].first;)
          ++last;
        quality.n_open_faces += last - first == 1;
        quality.conforming =
          quality.conforming && last - first <= 2 && (ids.count(faces[first].first) > 0) == (last - first == 1);
      }
    quality.conforming = quality.conforming && ids.size() == quality.n_open_faces;
    return quality;
  }

  /// Length of the faces with the given id.
  inline double length_of(const mesh::MeshPiece<2> &piece, const dealii::types::boundary_id id)
  {
    double length = 0;
    for (const auto &face : piece.boundary_faces)
      if (face.id == id)
        length += piece.vertices[face.vertices[0]].distance(piece.vertices[face.vertices[1]]);
    return length;
  }
} // namespace slipstick::test
