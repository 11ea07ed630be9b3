// Meshes of one hand-made piece.
#pragma once

#include "torn.h"

#include <slipstick/mesh/triangulate.h>

namespace slipstick::test
{
  inline mesh::Mesh<2> mesh_of(const mesh::MeshPiece<2> &piece)
  {
    mesh::Mesh<2> mesh;
    mesh.comm            = MPI_COMM_SELF;
    mesh.first_subdomain = {0, 1};
    mesh.boundary_ids    = {{{"left", 0}, {"right", 1}, {"bottom", 2}, {"top", 3}}};
    mesh.subdomains.push_back(mesh::triangulate(piece));
    return mesh;
  }

  /// A rectangle of unit cells in one piece, cells row by row.
  inline mesh::MeshPiece<2> unit_cells(const unsigned int n_x, const unsigned int n_y)
  {
    scene::Body<2> body;
    body.size = {double(n_x), double(n_y)};
    return mesh::rectangle_piece<2>(body, {{n_x, n_y}}, {{1, 1}}, {{0, 0}});
  }
} // namespace slipstick::test
