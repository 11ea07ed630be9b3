// probes.csv: results at points and along lines.
#pragma once

#include <slipstick/output/summary.h>

namespace slipstick::output
{
  /// Writes probes.csv, the points of every probe in every load step; nothing without probes. Collective.
  void write_probes(const OutputDirectory &directory, const std::vector<StepSummary> &steps, const unsigned int dim);
} // namespace slipstick::output
