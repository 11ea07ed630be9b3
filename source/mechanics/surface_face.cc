#include <slipstick/mechanics/surface_face.h>

#include <deal.II/base/mpi.h>

#include <boost/serialization/vector.hpp>

#include <algorithm>
#include <cmath>

namespace slipstick::mechanics
{
  namespace
  {
    SurfaceFace surface_face(const mesh::SubdomainMesh<3>                      &subdomain,
                             const Spaces<3>                                   &spaces,
                             const dealii::DoFHandler<3>::active_cell_iterator &cell,
                             const unsigned int                                 f)
    {
      constexpr std::array<unsigned int, 4> around = {{0, 1, 3, 2}}; // from deal.II's order, which is lexicographic
      SurfaceFace                           face;
      unsigned int                          v = 0;
      face.body                               = subdomain.body;
      face.subdomain                          = subdomain.subdomain;
      face.boundary                           = cell->face(f)->boundary_id();
      spaces.for_each_face_node(subdomain,
                                cell->face(f),
                                [&](const unsigned int, const NodeKey &key, const dealii::Point<3> &x) {
                                  if (v == around.size()) // those inside edges and faces come last
                                    return;
                                  face.keys[around[v]] = key;
                                  for (unsigned int d = 0; d < 3; ++d)
                                    face.at[around[v]][d] = x[d];
                                  ++v;
                                });
      if (face.normal() * (face.middle() - cell->center()) < 0)
        {
          std::swap(face.keys[1], face.keys[3]);
          std::swap(face.at[1], face.at[3]);
        }
      const auto first = std::min_element(face.keys.begin(), face.keys.end()) - face.keys.begin();
      std::rotate(face.at.begin(), face.at.begin() + first, face.at.end());
      std::rotate(face.keys.begin(), face.keys.begin() + first, face.keys.end());
      return face;
    }
  } // namespace

  dealii::Point<3> SurfaceFace::middle() const
  {
    dealii::Point<3> sum;
    for (unsigned int i = 0; i < 4; ++i)
      sum += dealii::Tensor<1, 3>(node(i));
    return sum / 4.;
  }

  dealii::Tensor<1, 3> SurfaceFace::normal() const
  {
    const auto across = cross_product_3d(node(2) - node(0), node(3) - node(1));
    return across / across.norm();
  }

  double SurfaceFace::chord() const
  {
    return std::max(node(0).distance(node(2)), node(1).distance(node(3)));
  }

  std::array<double, 4> SurfaceFace::shares() const
  {
    const double          gauss = 0.5 / std::sqrt(3.);
    std::array<double, 4> result{};
    for (const double s : {0.5 - gauss, 0.5 + gauss})
      for (const double t : {0.5 - gauss, 0.5 + gauss})
        {
          const auto                  along_s = (1 - t) * (node(1) - node(0)) + t * (node(2) - node(3));
          const auto                  along_t = (1 - s) * (node(3) - node(0)) + s * (node(2) - node(1));
          const double                area    = cross_product_3d(along_s, along_t).norm() / 4;
          const std::array<double, 4> N       = {{(1 - s) * (1 - t), s * (1 - t), s * t, (1 - s) * t}};
          for (unsigned int i = 0; i < 4; ++i)
            result[i] += N[i] * area;
        }
    return result;
  }

  std::vector<SurfaceFace> surfaces(const mesh::Mesh<3> &mesh, const Spaces<3> &spaces, const std::vector<bool> &wanted)
  {
    std::vector<SurfaceFace> own, all;
    for (unsigned int p = 0; p < mesh.subdomains.size(); ++p)
      if (wanted[mesh.subdomains[p]->body])
        for (const auto &cell : spaces.dof_handlers[p]->active_cell_iterators())
          for (const unsigned int f : cell->face_indices())
            if (cell->face(f)->at_boundary() && cell->face(f)->boundary_id() != mesh::cut_id)
              own.push_back(surface_face(*mesh.subdomains[p], spaces, cell, f));
    for (const auto &list : dealii::Utilities::MPI::all_gather(mesh.comm, own))
      all.insert(all.end(), list.begin(), list.end());
    std::sort(all.begin(), all.end());
    return all;
  }
} // namespace slipstick::mechanics
