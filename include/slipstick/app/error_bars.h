// Error bars: "1281 +- 9 MPa", results with the estimates of their errors.
#pragma once

#include <slipstick/app/goals.h>
#include <slipstick/output/summary.h>

namespace slipstick::app
{
  /// Error bars of the goals, and of the lengths of contact and stick, whose ends are known to half an element; in
  /// space of their areas.
  /// @param results the printed values: a goal whose value differs from them (pairs with nodes held by supports) gets
  /// no error bar.
  /// @param nodes of the last load step; only those of rank 0 are used.
  template <int dim>
  std::vector<output::ErrorBar> error_bars(const std::vector<GoalError>               &goals,
                                           const output::ResultSummary                &results,
                                           const std::vector<contact::ContactNode>    &nodes,
                                           const std::vector<scene::ContactPair<dim>> &pairs);

  /// Prints one line per quantity.
  void print_bars(const Log &log, const std::vector<output::ErrorBar> &bars);

  /// Prints which of the quantities @p promised, if any, have relative errors above @p accuracy.
  void print_inaccurate(const Log                           &log,
                        const std::vector<output::ErrorBar> &bars,
                        const std::vector<std::string>      &promised,
                        const double                         accuracy);
} // namespace slipstick::app
