// Decomposition of bodies into subdomains.
#pragma once

#include <slipstick/mesh/adaptive_refinement.h>
#include <slipstick/mesh/mesh.h>

namespace slipstick::mesh
{
  /// Builds the mesh of every body and decomposes it according to Scene::decomposition. Rectangles that are cut into
  /// blocks or not cut are built by every rank for its own subdomains; all other bodies are read, meshed and cut
  /// (METIS) by rank 0, which sends the subdomains to the other ranks. Every subdomain is connected through faces and
  /// has cells of one type. METIS subdomains are distributed among the bodies by cost, at least one each. `automatic`
  /// means METIS here.
  /// @param refinement local refinement, if any; all bodies are then cut by METIS. Its `cells` are set for this mesh.
  /// Collective. @throws InputError when there are fewer cells than subdomains, for a faulty mesh file (see
  /// body_mesh.h) and when the scene names a boundary or point that its body does not have.
  template <int dim>
  Mesh<dim> make_mesh(const scene::Scene<dim> &scene, const MPI_Comm comm, Refinement *refinement = nullptr);
} // namespace slipstick::mesh
