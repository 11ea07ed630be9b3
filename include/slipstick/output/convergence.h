// convergence.csv: progress of the solver, one row per outer step.
#pragma once

#include <slipstick/output/directory.h>

#include <cstdint>
#include <string>
#include <vector>

namespace slipstick::output
{
  struct ConvergenceRow
  {
    unsigned int  step = 0; // load step
    std::string   algorithm;
    unsigned int  friction_step           = 0;
    unsigned int  outer_step              = 0;
    std::uint64_t hessian_multiplications = 0; // since the end of set-up, over all steps
    double        projected_gradient      = 0; // relative, as in the stopping test
    double        equality                = 0; // relative, as in the stopping test
    std::uint64_t at_lower_bound          = 0; // inequality multipliers
    std::uint64_t at_upper_bound          = 0;
    std::uint64_t free                    = 0;
  };

  /// Writes convergence.csv from rank 0, whose @p rows are used; columns are the members in their order. Collective.
  void write_convergence(const OutputDirectory &directory, const std::vector<ConvergenceRow> &rows);
} // namespace slipstick::output
