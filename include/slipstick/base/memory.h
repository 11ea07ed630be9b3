// What memory there is.
#pragma once

namespace slipstick
{
  /// Free memory of this machine in MB, or what control groups and limits leave to @p n_ranks processes of the run on it;
  /// infinite where none of that can be read.
  double free_memory_mb(const unsigned int n_ranks);
} // namespace slipstick
