// Available memory.
#pragma once

#include <slipstick/base/exceptions.h>

namespace slipstick
{
  /// What a std::bad_alloc is to the user: the scene is too large for the machine, or for what it leaves to this process.
  InputError out_of_memory();

  /// Free memory of this machine in MB, or what control groups and limits leave to @p n_ranks processes of the run on
  /// it (of limited address spaces what this process has not taken yet); infinite if none of this can be read.
  double free_memory_mb(const unsigned int n_ranks);
} // namespace slipstick
