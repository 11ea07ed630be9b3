// Gathers values of the rows of all ranks.
#pragma once

#include <slipstick/base/gather.h>

#include <deal.II/base/exceptions.h>

#include <cstdint>
#include <map>
#include <vector>

namespace slipstick::tfeti
{
  /// Values of the rows of all ranks, on every rank, ordered by the labels of the rows (Constraints::label), so that
  /// the order does not depend on the number of ranks. No two rows may have the same label. @p Value is packed by
  /// Boost. Collective.
  template <typename Value>
  std::map<std::uint64_t, Value> gathered_by_label(const std::vector<std::uint64_t> &labels,
                                                   const std::vector<Value>         &values,
                                                   const MPI_Comm                    comm)
  {
    std::map<std::uint64_t, Value> all;
    const auto                     labels_of = all_gather(comm, labels);
    const auto                     values_of = all_gather(comm, values);
    for (unsigned int rank = 0; rank < labels_of.size(); ++rank)
      for (unsigned int i = 0; i < labels_of[rank].size(); ++i)
        {
          const bool is_new = all.emplace(labels_of[rank][i], values_of[rank][i]).second;
          AssertThrow(is_new, dealii::ExcMessage("two rows of the dual problem have the same label"));
        }
    return all;
  }
} // namespace slipstick::tfeti
