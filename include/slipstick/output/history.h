// history.csv: forces on the bodies, one row per load step.
#pragma once

#include <slipstick/output/summary.h>

namespace slipstick::output
{
  /// Writes history.csv from rank 0, whose @p steps are used: step, t, then Fx, Fy, moment of every load, support,
  /// foundation and contact pair (on its slave body); columns "KIND NAME Fx"; in space also Fz and three moments. Then
  /// force and shortening of every bolt, and the displacement of every probed point. Collective.
  void write_history(const OutputDirectory &directory, const std::vector<StepSummary> &steps, const unsigned int dim);
} // namespace slipstick::output
