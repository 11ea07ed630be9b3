// From bodies to subdomains.
#pragma once

#include <slipstick/fem/mesh.h>

namespace slipstick::fem
{
  /// Builds the mesh of every body and cuts it as Scene::decomposition says. With blocks every rank makes its own
  /// subdomains and nothing else; with METIS rank 0 meshes and partitions, the others receive their subdomains.
  /// Subdomains that METIS leaves disconnected or hinged at a vertex are split into parts connected through faces.
  /// Collective. @throws InputError when there are fewer cells than subdomains.
  template <int dim>
  Mesh<dim> make_mesh(const scene::Scene<dim> &scene, const MPI_Comm comm);
} // namespace slipstick::fem
