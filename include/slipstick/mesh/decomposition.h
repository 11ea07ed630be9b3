// From bodies to subdomains.
#pragma once

#include <slipstick/mesh/adaptive_refinement.h>
#include <slipstick/mesh/mesh.h>

namespace slipstick::mesh
{
  /// Builds the mesh of every body and decomposes it according to Scene::decomposition. Rectangles cut into blocks or
  /// not at all are made by every rank for its own subdomains; everything else is read, made and cut (METIS) by rank 0,
  /// and the others receive their subdomains. Every subdomain is connected through faces and has cells of one type.
  /// METIS' subdomains are shared among the bodies by cost, at least one each. `automatic` means METIS here.
  /// @param refinement of single cells, if any; all bodies are then cut by METIS. Its `cells` become those of this mesh.
  /// Collective. @throws InputError when there are fewer cells than subdomains, for a bad mesh file (see body_mesh.h)
  /// and when the scene names a boundary or point that its body does not have.
  template <int dim>
  Mesh<dim> make_mesh(const scene::Scene<dim> &scene, const MPI_Comm comm, Refinement *refinement = nullptr);
} // namespace slipstick::mesh
