// Gathers one object of each rank. deal.II's functions of these names compress what they send, on one rank too, which
// took a tenth of the time of a scene in space.
#pragma once

#include <deal.II/base/mpi.h>
#include <deal.II/base/utilities.h>

#include <optional>
#include <utility>
#include <vector>

namespace slipstick
{
  namespace detail
  {
    /// The bytes of all ranks one after another; those of rank r begin at begin[r] and end at begin[r + 1]. If @p root
    /// is given, only that rank receives them, and both are empty on the others. Collective.
    struct GatheredBytes
    {
      GatheredBytes(const MPI_Comm comm, const std::vector<char> &own, std::optional<unsigned int> root);

      std::vector<char> bytes;
      std::vector<int>  begin;
    };

    /// The objects of all ranks that receive, by rank.
    template <class T>
    std::vector<T> gathered(const MPI_Comm comm, T own, const std::optional<unsigned int> root)
    {
      std::vector<T> all;
      if (dealii::Utilities::MPI::n_mpi_processes(comm) == 1)
        {
          all.push_back(std::move(own));
          return all;
        }
      const GatheredBytes received(comm, dealii::Utilities::pack(own, false), root);
      for (unsigned int r = 0; r + 1 < received.begin.size(); ++r)
        all.push_back(dealii::Utilities::unpack<T>(received.bytes.cbegin() + received.begin[r],
                                                   received.bytes.cbegin() + received.begin[r + 1],
                                                   false));
      return all;
    }
  } // namespace detail

  /// The objects of all ranks, by rank, on every rank. @p T is packed by Boost. Collective.
  template <class T>
  std::vector<T> all_gather(const MPI_Comm comm, T own)
  {
    return detail::gathered(comm, std::move(own), {});
  }

  /// The objects of all ranks, by rank, on rank 0; empty on the others. @p T is packed by Boost. Collective.
  template <class T>
  std::vector<T> gather(const MPI_Comm comm, T own)
  {
    return detail::gathered(comm, std::move(own), 0);
  }
} // namespace slipstick
