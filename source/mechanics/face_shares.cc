#include <slipstick/mechanics/face_shares.h>
#include <slipstick/mechanics/surface_facet.h>

namespace slipstick::mechanics
{
  // The nodes of the edge or facet may be numbered differently from those of the face.
  template <int dim>
  std::vector<FaceShare<dim>> face_shares(const mesh::SubdomainMesh<dim>                               &subdomain,
                                          const Spaces<dim>                                            &spaces,
                                          const typename dealii::DoFHandler<dim>::active_cell_iterator &cell,
                                          const unsigned int                                            f,
                                          const mesh::Kinematics<dim>                                  &kinematics)
  {
    const auto                  part     = surface_part(subdomain, spaces, cell, f);
    const auto                  lengths  = part.tributary_lengths();
    const auto                  measures = part.tributary_measures(kinematics);
    std::vector<FaceShare<dim>> shares;
    spaces.for_each_face_node(subdomain,
                              cell->face(f),
                              [&](const unsigned int, const NodeKey &key, const dealii::Point<dim> &) {
                                unsigned int i = 0;
                                while (part.keys[i] != key)
                                  ++i;
                                shares.push_back({measures[i], lengths[i], part.normal_at(i)});
                              });
    return shares;
  }

  template std::vector<FaceShare<2>> face_shares(const mesh::SubdomainMesh<2> &,
                                                 const Spaces<2> &,
                                                 const dealii::DoFHandler<2>::active_cell_iterator &,
                                                 const unsigned int,
                                                 const mesh::Kinematics<2> &);
  template std::vector<FaceShare<3>> face_shares(const mesh::SubdomainMesh<3> &,
                                                 const Spaces<3> &,
                                                 const dealii::DoFHandler<3>::active_cell_iterator &,
                                                 const unsigned int,
                                                 const mesh::Kinematics<3> &);
} // namespace slipstick::mechanics
