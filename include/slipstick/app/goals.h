// Errors of result quantities by dual weighted residuals, for a fixed contact state.
#pragma once

#include <slipstick/app/functionals.h>
#include <slipstick/app/step_solver.h>
#include <slipstick/mechanics/probes.h>
#include <slipstick/mechanics/singular_points.h>

#include <string>
#include <vector>

namespace slipstick::app
{
  /// Estimated discretisation error of one quantity.
  struct GoalError
  {
    std::string                  quantity; // as in Goal
    std::string                  unit;
    bool                         is_known = false;
    std::string                  reason;                // why there is no estimate
    bool                         is_resolvable = false; // finer cells remove the reason
    bool                         is_infinite   = false; // the reason: no mesh has an estimate
    bool                         is_singular   = false; // the reason: a singular point, where stresses may be infinite
    double                       value         = 0;     // of the quantity
    double                       correction    = 0;     // sum over the cells, to be added to the value
    double                       absolute      = 0;     // sum of the magnitudes
    double                       local         = 0;     // in addition to the cells: Functional::local_error
    double                       shortfall     = 0;     // Functional::shortfall
    std::string                  note;                  // Functional::note
    std::vector<Eigen::VectorXd> cells;                 // by subdomain of this rank: contributions of the cells
  };

  /// Dual weighted residuals (Becker, Rannacher, Acta Numerica 2001): the error of a quantity is the energy product of
  /// the errors of the solution and of the adjoint displacement, which solves a linear problem on the active set of the
  /// solution (contact::Adjoint); the effect of the gaps between the nodes is added (interface::gap_defects). Both
  /// errors in energy products are those of recovered stresses, as in the estimate of the energy norm. Friction at
  /// slipping nodes follows the normal force; in space it keeps its direction, and the tangential force is the sum of
  /// the magnitudes at the nodes.
  /// @param peaks peaks of the contact pressure, where stresses are not resolved.
  /// @param requested quantities whose errors are requested: all of its goals have one, if only a reason.
  /// Changes the dual problem of @p solver, which is set to the last load step. Collective.
  template <int dim>
  std::vector<GoalError> goal_errors(StepSolver<dim>                                 &solver,
                                     const mechanics::Probes<dim>                    &probes,
                                     const StepSolution                              &answer,
                                     const double                                     t,
                                     const std::vector<mechanics::Surroundings<dim>> &peaks,
                                     const RequestedBars                             &requested);
} // namespace slipstick::app
