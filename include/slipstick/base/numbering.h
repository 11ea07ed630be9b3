// Consecutive global numbers over the ranks.
#pragma once

#include <mpi.h>

#include <cstdint>
#include <utility>

namespace slipstick
{
  /// First global number of the @p n_owned items of this rank, and their total over all ranks. Collective.
  std::pair<std::uint64_t, std::uint64_t> first_and_total(const std::uint64_t n_owned, const MPI_Comm comm);
} // namespace slipstick
