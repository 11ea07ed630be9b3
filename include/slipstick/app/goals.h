// Errors of the figures that a user reads off, by dual weighted residuals with the contact set as it was found.
#pragma once

#include <slipstick/app/step_solver.h>
#include <slipstick/mechanics/probes.h>

#include <string>
#include <vector>

namespace slipstick::app
{
  /// Estimated discretisation error of one figure.
  struct GoalError
  {
    std::string                  quantity; // as in Goal
    std::string                  unit;
    bool                         is_known = false;
    std::string                  reason;       // why it is not
    double                       value    = 0; // of the figure
    double                       signed_  = 0; // sum over the cells: what should be added to the figure
    double                       absolute = 0; // sum of the magnitudes
    std::vector<Eigen::VectorXd> cells;        // by subdomain of this rank: the parts of the cells
  };

  /// Dual weighted residuals (Becker, Rannacher, Acta Numerica 2001): the error of a figure is the energy product of the
  /// errors of the solution and of the displacement that the figure stands for, a linear problem on the set of the solution
  /// (contact::Adjoint); added is what the gaps between the nodes would change (interface::gap_defects). Both errors of energy products are those of recovered stresses, as in the estimate of the energy norm. Bounds of
  /// friction stay as they are in that problem; in the tangential force of a pair that slides as a whole they follow the
  /// pressure. In space friction forces of slipping nodes keep their directions, too, and the tangential force is the sum of their
  /// magnitudes.
  /// @param quantities of which errors are wanted; empty: all.
  /// The dual problem of @p solver is changed: for the last load step. Collective.
  template <int dim>
  std::vector<GoalError> goal_errors(StepSolver<dim>                &solver,
                                     const mechanics::Probes<dim>   &probes,
                                     const StepAnswer               &answer,
                                     const double                    t,
                                     const std::vector<std::string> &quantities);
} // namespace slipstick::app
