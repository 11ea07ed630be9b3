// From a piece of mesh to the triangulation of a subdomain.
#pragma once

#include <slipstick/mesh/mesh_piece.h>

namespace slipstick::mesh
{
  /// The triangulation of a piece, whose cells are all of one kind; faces that lie on no boundary of the body get
  /// cut_id. Faces with curves get a manifold on which mappings of degree 2 put their midside nodes, unless that would
  /// spoil the cell (see EdgeMiddles).
  template <int dim>
  std::unique_ptr<SubdomainMesh<dim>> triangulate(const MeshPiece<dim> &piece);
} // namespace slipstick::mesh
