// Available memory.
#pragma once

#include <slipstick/base/exceptions.h>

#include <mpi.h>

namespace slipstick
{
  /// Whether an error means that memory ran out: std::bad_alloc, or the corresponding exception of deal.II.
  bool is_out_of_memory(const std::exception &error);

  /// The error reported when memory runs out: the scene is too large for the machine, or for the memory limit of this
  /// process.
  InputError out_of_memory();

  /// The share of this process in the free memory of its machine [MB], which control groups and resource limits may
  /// restrict (of a limited address space: the part that this process does not use); infinite if none of this can be
  /// read. Collective.
  double share_of_free_memory_mb(const MPI_Comm comm);
} // namespace slipstick
