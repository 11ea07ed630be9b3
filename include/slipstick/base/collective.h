// Throws an error found on one rank on all ranks, so that no rank is left waiting.
#pragma once

#include <mpi.h>

#include <functional>

namespace slipstick
{
  /// Runs @p stage, which must contain no communication, on every rank. When it throws on any of them, every rank
  /// throws the error of the lowest such rank, of the same type (InputError, NoEquilibrium, NumericalError; anything
  /// else becomes std::runtime_error). Collective.
  void collectively(const MPI_Comm comm, const std::function<void()> &stage);
} // namespace slipstick
