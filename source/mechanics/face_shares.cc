#include <slipstick/mechanics/face_shares.h>
#include <slipstick/mechanics/surface.h>

#include <cmath>

namespace slipstick::mechanics
{
  // The edge may run the other way than the face.
  template <>
  std::vector<FaceShare<2>> face_shares(const mesh::SubdomainMesh<2>                      &subdomain,
                                        const Spaces<2>                                   &spaces,
                                        const dealii::DoFHandler<2>::active_cell_iterator &cell,
                                        const unsigned int                                 f,
                                        const mesh::Kinematics<2>                         &kinematics)
  {
    const auto                edge     = surface_edge(subdomain, spaces, cell, f);
    const auto                lengths  = edge.tributary_lengths();
    const auto                measures = edge.tributary_measures(kinematics);
    std::vector<FaceShare<2>> shares;
    spaces.for_each_face_node(subdomain,
                              cell->face(f),
                              [&](const unsigned int, const NodeKey &key, const dealii::Point<2> &) {
                                unsigned int i = 0;
                                while (edge.keys[i] != key)
                                  ++i;
                                shares.push_back({measures[i], lengths[i], edge.normal(edge.node_coordinate(i))});
                              });
    return shares;
  }

  // Bilinear: two Gauss points a direction integrate the area of plane faces exactly.
  template <>
  std::vector<FaceShare<3>> face_shares(const mesh::SubdomainMesh<3> &,
                                        const Spaces<3> &,
                                        const dealii::DoFHandler<3>::active_cell_iterator &cell,
                                        const unsigned int                                 f,
                                        const mesh::Kinematics<3> &)
  {
    const auto             face       = cell->face(f);
    constexpr unsigned int n_vertices = 4;
    const auto             shape      = [](const unsigned int v, const double s, const double t) {
      return (v % 2 == 0 ? 1 - s : s) * (v / 2 == 0 ? 1 - t : t);
    };
    const auto area_vector = [&](const double s, const double t) { // across the face, its length that of the area
      const auto along_s = (1 - t) * (face->vertex(1) - face->vertex(0)) + t * (face->vertex(3) - face->vertex(2));
      const auto along_t = (1 - s) * (face->vertex(2) - face->vertex(0)) + s * (face->vertex(3) - face->vertex(1));
      return cross_product_3d(along_s, along_t);
    };
    const double              outward = area_vector(0.5, 0.5) * (face->center() - cell->center()) < 0 ? -1. : 1.;
    const double              gauss   = 0.5 / std::sqrt(3.);
    std::vector<FaceShare<3>> shares(n_vertices);
    for (unsigned int v = 0; v < n_vertices; ++v)
      {
        for (const double s : {0.5 - gauss, 0.5 + gauss})
          for (const double t : {0.5 - gauss, 0.5 + gauss})
            shares[v].measure += shape(v, s, t) * area_vector(s, t).norm() / 4;
        shares[v].length = shares[v].measure;
        const auto at    = area_vector(v % 2, v / 2);
        shares[v].normal = outward * at / at.norm();
      }
    return shares;
  }
} // namespace slipstick::mechanics
