// Estimated size of a scene, computed before anything large is created.
#pragma once

#include <slipstick/mesh/mesh.h>

namespace slipstick::mesh
{
  /// Estimate of a run.
  struct SizeEstimate
  {
    double      cells = 0, unknowns = 0;
    double      memory_mb = 0; // of all ranks together
    std::string largest;       // the body with the most cells, and the reason
  };

  /// Estimate from the numbers in the scene and the number of cells in mesh files. Files of bodies that are not refined
  /// are read only with @p reads_files; otherwise their size tells the number of cells, too large by up to 10 times.
  /// @throws InputError as read_mesh_file() does.
  template <int dim>
  SizeEstimate estimate_size(const scene::Scene<dim> &scene, const bool reads_files = false);

  /// @throws InputError on all ranks if the estimated memory exceeds the available memory, unless @p forced, and in any
  /// case if the number of cells is too large to be counted. Collective.
  template <int dim>
  void check_size(const scene::Scene<dim> &scene, const bool forced, const MPI_Comm comm);

  /// Refuses bodies so far from the origin that rounding would distort their cells. Collective.
  /// @throws InputError on all ranks.
  template <int dim>
  void check_positions(const scene::Scene<dim> &scene, const Mesh<dim> &mesh);
} // namespace slipstick::mesh
