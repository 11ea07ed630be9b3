#include <slipstick/base/numbering.h>

namespace slipstick
{
  std::pair<std::uint64_t, std::uint64_t> first_and_total(const std::uint64_t n_owned, const MPI_Comm comm)
  {
    std::uint64_t first = 0, total = 0;
    MPI_Exscan(&n_owned, &first, 1, MPI_UINT64_T, MPI_SUM, comm);
    MPI_Allreduce(&n_owned, &total, 1, MPI_UINT64_T, MPI_SUM, comm);
    int rank;
    MPI_Comm_rank(comm, &rank);
    return {rank == 0 ? 0 : first, total};
  }
} // namespace slipstick
