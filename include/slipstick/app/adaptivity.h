// From mesh to mesh until an accuracy is reached: what to refine, when to stop.
#pragma once

#include <slipstick/app/goals.h>
#include <slipstick/output/summary.h>
#include <slipstick/scene/adaptivity.h>

#include <optional>

namespace slipstick::app
{
  /// Errors of the cells of one mesh, such that they add up.
  struct CellErrors
  {
    std::vector<Eigen::VectorXd> of_cells;    // by subdomain of this rank, >= 0
    double                       total   = 0; // over all ranks
    double                       allowed = 0; // total to be reached
  };

  /// Where the exact energy is infinite, so that its error does not fall: the surroundings of a point force.
  template <int dim>
  struct LeftOut
  {
    unsigned int       body = 0;
    dealii::Point<dim> position;
    double             radius = 0; // of the cells around it on the first mesh [mm]
    std::string        what;       // "the point load tip"
  };

  /// Of all point loads and point supports. Collective.
  template <int dim>
  std::vector<LeftOut<dim>> point_forces(const scene::Scene<dim>      &scene,
                                         const mesh::Mesh<dim>        &mesh,
                                         const mechanics::Spaces<dim> &spaces,
                                         const unsigned int            n_supports);

  /// Of the estimate in the energy norm: squares over that of the displacement. Collective.
  template <int dim>
  CellErrors energy_errors(const mesh::Mesh<dim>           &mesh,
                           const mechanics::StressResult   &stress,
                           const std::vector<LeftOut<dim>> &left_out,
                           const double                     accuracy);

  /// Of goals: magnitudes over the figures, the sum of all. Collective.
  CellErrors errors_of_goals(const std::vector<GoalError> &goals, const double accuracy, const MPI_Comm comm);

  /// Puts the cells with the largest errors into @p refinement: the fewest that make the error small enough if it falls as on
  /// smooth solutions, at most those with `most_of_error` of it. Collective.
  /// @return their number.
  template <int dim>
  std::size_t mark(const mesh::Mesh<dim> &mesh, const CellErrors &errors, mesh::Refinement &refinement);

  /// Relative error of the worst of the goals; nothing if one of them has none. On rank 0.
  std::optional<double> worst_error(const std::vector<output::ErrorBar> &bars, const std::vector<std::string> &goals);
} // namespace slipstick::app
