// Available memory.
#pragma once

namespace slipstick
{
  /// Free memory of this machine in MB, or what control groups and limits leave to @p n_ranks processes of the run on
  /// it; infinite if none of this can be read.
  double free_memory_mb(const unsigned int n_ranks);
} // namespace slipstick
