// The pipeline: from a scene to its answer, checked and written.
#pragma once

#include <slipstick/base/exceptions.h>
#include <slipstick/base/log.h>
#include <slipstick/scene/scene.h>

namespace slipstick::app
{
  /// Builds and checks everything that the solver needs, prints the scene's table, solves nothing. Collective.
  void check_scene(const scene::Scene<2> &scene, const Log &log, const MPI_Comm comm);

  /// Solves @p scene and writes the results to @p output_directory. Collective.
  /// @return converged or not_converged; outputs are written in both cases.
  /// @throws InputError, NoEquilibrium, NumericalError on all ranks alike.
  ExitStatus run(const scene::Scene<2> &scene,
                 const std::string     &output_directory,
                 const Log             &log,
                 const MPI_Comm         comm);
} // namespace slipstick::app
