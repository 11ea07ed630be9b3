// The complete analysis of a scene: mesh, solution, checks, output.
#pragma once

#include <slipstick/base/exceptions.h>
#include <slipstick/base/log.h>
#include <slipstick/scene/adaptivity.h>

namespace slipstick::app
{
  /// Builds and checks everything that the solver needs and prints the table of the scene, without solving. Collective.
  /// @param picture file for a drawing of the scene (SVG); empty: none.
  template <int dim>
  void check_scene(const scene::Scene<dim> &scene, const std::string &picture, const Log &log, const MPI_Comm comm);

  /// Solves @p scene, on refined meshes if @p adaptivity specifies an accuracy, and writes the results to @p
  /// output_directory. Collective.
  /// @param resumes continues after the last completed load step of an earlier run there and gives the same results as
  /// an uninterrupted run.
  /// @return converged or not_converged; results are written in both cases.
  /// @throws InputError, NoEquilibrium, NumericalError on all ranks.
  template <int dim>
  ExitStatus run(const scene::Scene<dim>        &scene,
                 const scene::AdaptivityOptions &adaptivity,
                 const std::string              &output_directory,
                 const bool                      resumes,
                 const Log                      &log,
                 const MPI_Comm                  comm);
} // namespace slipstick::app
