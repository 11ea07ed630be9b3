// The triangulation of a subdomain from a piece of mesh.
#pragma once

#include <slipstick/mesh/mesh_piece.h>

namespace slipstick::mesh
{
  /// The triangulation of a piece, whose cells are all of one kind; faces that are not on a boundary of the body get
  /// cut_id. Faces with curves get a manifold on which mappings of degree 2 place their midside nodes, unless that
  /// would distort the cell (see EdgeMiddles).
  template <int dim>
  std::unique_ptr<SubdomainMesh<dim>> triangulate(const MeshPiece<dim> &piece);
} // namespace slipstick::mesh
