// Sums and minima over the ranks for the solvers in qp.
#pragma once

#include <mpi.h>

#include <array>

namespace slipstick::tfeti
{
  /// qp's Reduction over a communicator. The result is bitwise the same on every rank.
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
