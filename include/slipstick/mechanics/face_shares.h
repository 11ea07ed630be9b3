// Tributary areas and normals of the nodes of a boundary face.
#pragma once

#include <slipstick/mechanics/spaces.h>
#include <slipstick/mesh/kinematics.h>

namespace slipstick::mechanics
{
  /// Share of a node in a boundary face.
  template <int dim>
  struct FaceShare
  {
    double measure = 0;                // integral of its shape function, per thickness or over the circumference;
                                       // in space the area [mm], [mm^2]
    double                 length = 0; // the same without circumference; in space the area
    dealii::Tensor<1, dim> normal;     // outward at the node, unit length
  };

  /// Shares of the nodes of face @p face of @p cell, in the order of Spaces::for_each_face_node().
  template <int dim>
  std::vector<FaceShare<dim>> face_shares(const mesh::SubdomainMesh<dim>                               &subdomain,
                                          const Spaces<dim>                                            &spaces,
                                          const typename dealii::DoFHandler<dim>::active_cell_iterator &cell,
                                          const unsigned int                                            face,
                                          const mesh::Kinematics<dim>                                  &kinematics);
} // namespace slipstick::mechanics
