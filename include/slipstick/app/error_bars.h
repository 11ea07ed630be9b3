// "1281 +- 9 MPa": figures of the results with the estimates of their errors.
#pragma once

#include <slipstick/app/goals.h>
#include <slipstick/output/summary.h>

namespace slipstick::app
{
  /// Bars of the goals, and of the lengths of contact and stick, which are known to an element at each of their ends.
  /// @param nodes of the last load step, along their pairs; on rank 0, whose result counts.
  std::vector<output::ErrorBar> error_bars(const std::vector<GoalError>             &goals,
                                           const std::vector<contact::ContactNode>  &nodes,
                                           const std::vector<scene::ContactPair<2>> &pairs);

  /// A line a figure.
  void print_bars(const Log &log, const std::vector<output::ErrorBar> &bars);
} // namespace slipstick::app
