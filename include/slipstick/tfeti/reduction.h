// Sums and minima over the ranks, as the solvers in qp need them.
#pragma once

#include <mpi.h>

#include <array>

namespace slipstick::tfeti
{
  /// qp's Reduction over a communicator. Every rank gets the same bits.
  class MpiReduction
  {
  public:
    explicit MpiReduction(const MPI_Comm comm)
      : comm(comm)
    {}

    template <std::size_t n>
    std::array<double, n> sum(std::array<double, n> values) const
    {
      MPI_Allreduce(MPI_IN_PLACE, values.data(), n, MPI_DOUBLE, MPI_SUM, comm);
      return values;
    }

    double min(double value) const
    {
      MPI_Allreduce(MPI_IN_PLACE, &value, 1, MPI_DOUBLE, MPI_MIN, comm);
      return value;
    }

  private:
    MPI_Comm comm;
  };
} // namespace slipstick::tfeti
