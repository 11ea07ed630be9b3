// Adaptive refinement until an accuracy is reached: marking of cells, stopping.
#pragma once

#include <slipstick/app/goals.h>
#include <slipstick/output/summary.h>
#include <slipstick/scene/adaptivity.h>

#include <map>
#include <optional>

namespace slipstick::app
{
  /// Additive error contributions of the cells of one mesh.
  struct CellErrors
  {
    std::vector<Eigen::VectorXd> of_cells;    // by subdomain of this rank, >= 0
    double                       total   = 0; // over all ranks
    double                       allowed = 0; // target of `total`
  };

  /// Surroundings of a point force. The exact energy is infinite there, so that its error does not decrease.
  template <int dim>
  struct LeftOut
  {
    unsigned int       body = 0;
    dealii::Point<dim> position;
    double             radius = 0; // of the cells around it in the first mesh [mm]
    std::string        what;       // "the point load tip"
  };

  /// The surroundings of all point loads and point supports. Collective.
  template <int dim>
  std::vector<LeftOut<dim>> point_forces(const scene::Scene<dim>      &scene,
                                         const mesh::Mesh<dim>        &mesh,
                                         const mechanics::Spaces<dim> &spaces,
                                         const unsigned int            n_supports);

  /// Cell errors from the estimate in the energy norm: squares relative to that of the displacement. Collective.
  template <int dim>
  CellErrors energy_errors(const mesh::Mesh<dim>           &mesh,
                           const mechanics::StressResult   &stress,
                           const std::vector<LeftOut<dim>> &left_out,
                           const double                     accuracy);

  /// Cell errors from goals: magnitudes relative to the values, summed over the goals. Collective.
  CellErrors errors_of_goals(const std::vector<GoalError> &goals, const double accuracy, const MPI_Comm comm);

  /// Adds the cells with the largest errors to @p refinement: the fewest that make the error small enough if it
  /// decreases as for smooth solutions, but at most those that contribute `most_of_error` of the error. Collective.
  /// @return their number.
  template <int dim>
  std::size_t mark(const mesh::Mesh<dim> &mesh, const CellErrors &errors, mesh::Refinement &refinement);

  /// The largest error of the goals over their scales; nothing if one of them has no estimate. On rank 0.
  std::optional<double> worst_error(const std::vector<output::ErrorBar> &bars,
                                    const std::map<std::string, double> &scales);
} // namespace slipstick::app
