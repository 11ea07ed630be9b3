// Data that the solver passes from one load step to the next.
#pragma once

#include <slipstick/contact/checks.h>
#include <slipstick/output/convergence.h>

#include <cstdint>
#include <vector>

namespace slipstick::app
{
  /// State of one rank after a step; together with the scene it determines the next step completely.
  struct StepState
  {
    double           kept_part    = 0;               // of the length of slave boundaries, see StepProblem::kept_part()
    double           largest_load = 0;               // of the steps so far [N]
    double           built_at     = 0;               // load factor of the rows, see StepProblem
    contact::History history;                        // of the steps so far
    std::vector<output::ConvergenceRow> rows;        // of convergence.csv
    std::vector<std::uint64_t>          labels;      // of the owned rows
    std::vector<double>                 multipliers; // of the owned rows [N]
    bool                                has_gradient = false;   // contact::DualSolution::gradient ...
    std::vector<double>                 gradient;               // ... of the owned rows [N]
    double                              reference          = 0; // as in contact::DualSolution
    double                              weighted_reference = 0;
    double                              largest_forces     = 0;
    double                              largest_traction   = 0;
    std::vector<std::vector<double>>    u; // of this rank's subdomains [mm]

    /// A direction in the store, with its product with F and the error of that (qp/direction_store.h); owned rows.
    struct Direction
    {
      std::vector<double> p, Fp;
      double              error;
    };
    std::vector<Direction> directions; // oldest first

    std::vector<std::vector<double>> bolts; // from Tightening::state()
  };
} // namespace slipstick::app
