// Meshes of one hand-made piece.
#pragma once

#include "torn.h"

#include <slipstick/fem/triangulate.h>

namespace slipstick::test
{
  inline fem::Mesh<2> mesh_of(const fem::MeshPiece<2> &piece)
  {
    fem::Mesh<2> mesh;
    mesh.comm            = MPI_COMM_SELF;
    mesh.first_subdomain = {0, 1};
    mesh.boundary_ids    = {{{"left", 0}, {"right", 1}, {"bottom", 2}, {"top", 3}}};
    mesh.subdomains.push_back(fem::triangulate(piece));
    return mesh;
  }

  /// A rectangle of unit cells in one piece, cells row by row.
  inline fem::MeshPiece<2> unit_cells(const unsigned int n_x, const unsigned int n_y)
  {
    scene::Body<2> body;
    body.size = {double(n_x), double(n_y)};
    return fem::rectangle_piece<2>(body, {{n_x, n_y}}, {{1, 1}}, {{0, 0}});
  }
} // namespace slipstick::test
