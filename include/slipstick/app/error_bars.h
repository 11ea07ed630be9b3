// "1281 +- 9 MPa": figures of the results with the estimates of their errors.
#pragma once

#include <slipstick/app/goals.h>
#include <slipstick/output/summary.h>

namespace slipstick::app
{
  /// Bars of the goals, and of the lengths of contact and stick, whose ends are known to half an element; in space of their areas.
  /// @param results what is printed: a goal that does not reproduce its figure there (of a pair some of whose nodes supports
  /// hold) has no bar.
  /// @param nodes of the last load step; on rank 0, whose result counts.
  template <int dim>
  std::vector<output::ErrorBar> error_bars(const std::vector<GoalError>               &goals,
                                           const output::ResultSummary                &results,
                                           const std::vector<contact::ContactNode>    &nodes,
                                           const std::vector<scene::ContactPair<dim>> &pairs);

  /// A line a figure.
  void print_bars(const Log &log, const std::vector<output::ErrorBar> &bars);

  /// Those of the figures @p promised whose errors are larger than the part @p accuracy of them, if any.
  void print_inaccurate(const Log                           &log,
                        const std::vector<output::ErrorBar> &bars,
                        const std::vector<std::string>      &promised,
                        const double                         accuracy);
} // namespace slipstick::app
