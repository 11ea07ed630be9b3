// The pipeline: from a scene to its answer, checked and written.
#pragma once

#include <slipstick/base/exceptions.h>
#include <slipstick/base/log.h>
#include <slipstick/scene/adaptivity.h>

namespace slipstick::app
{
  /// Builds and checks everything that the solver needs, prints the scene's table, solves nothing. Collective.
  /// @param picture file for a drawing of the scene (SVG); empty: none. Of scenes in the plane.
  template <int dim>
  void check_scene(const scene::Scene<dim> &scene, const std::string &picture, const Log &log, const MPI_Comm comm);

  /// Solves @p scene, on finer meshes where @p adaptivity asks for an accuracy, and writes the results to
  /// @p output_directory. Collective.
  /// @param resumes continues after the last finished load step of an earlier run there and gives the same answer as an
  /// uninterrupted run.
  /// @return converged or not_converged; outputs are written in both cases.
  /// @throws InputError, NoEquilibrium, NumericalError on all ranks alike.
  template <int dim>
  ExitStatus run(const scene::Scene<dim>        &scene,
                 const scene::AdaptivityOptions &adaptivity,
                 const std::string              &output_directory,
                 const bool                      resumes,
                 const Log                      &log,
                 const MPI_Comm                  comm);
} // namespace slipstick::app
