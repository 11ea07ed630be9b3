// What a scene asks for, before anything of that size is made.
#pragma once

#include <slipstick/mesh/mesh.h>

namespace slipstick::mesh
{
  /// Estimate of a run.
  struct SizeEstimate
  {
    double      cells = 0, unknowns = 0;
    double      memory_mb = 0; // of all ranks together
    std::string largest;       // the body with the most cells, and what makes them
  };

  /// From the numbers in the scene and, where bodies of mesh files are refined, the cells in the files.
  /// @throws InputError as read_mesh_file() does.
  template <int dim>
  SizeEstimate estimate_size(const scene::Scene<dim> &scene);

  /// @throws InputError on all ranks alike where the estimated memory is more than what is there, unless @p forced, and in any
  /// case where cells could not be counted. Collective.
  template <int dim>
  void check_size(const scene::Scene<dim> &scene, const bool forced, const MPI_Comm comm);

  /// Bodies that lie so far from the origin that their cells would be made of rounding. Collective.
  /// @throws InputError on all ranks alike.
  template <int dim>
  void check_positions(const scene::Scene<dim> &scene, const Mesh<dim> &mesh);
} // namespace slipstick::mesh
