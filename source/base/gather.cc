#include <slipstick/base/exceptions.h>
#include <slipstick/base/gather.h>

#include <limits>

namespace slipstick::detail
{
  GatheredBytes::GatheredBytes(const MPI_Comm                    comm,
                               const std::vector<char>          &own,
                               const std::optional<unsigned int> root)
  {
    using dealii::Utilities::MPI::n_mpi_processes;
    using dealii::Utilities::MPI::this_mpi_process;
    if (dealii::Utilities::MPI::sum(own.size(), comm) > static_cast<std::size_t>(std::numeric_limits<int>::max()))
      throw InputError("the ranks would exchange more than 2 GB in one message, the limit of MPI",
                       "use a coarser mesh");
    const int        n_own       = own.size();
    const bool       is_receiver = !root || this_mpi_process(comm) == *root;
    std::vector<int> sizes(is_receiver ? n_mpi_processes(comm) : 0);
    if (root)
      MPI_Gather(&n_own, 1, MPI_INT, sizes.data(), 1, MPI_INT, *root, comm);
    else
      MPI_Allgather(&n_own, 1, MPI_INT, sizes.data(), 1, MPI_INT, comm);
    if (is_receiver)
      {
        begin.push_back(0);
        for (const int size : sizes)
          begin.push_back(begin.back() + size);
        bytes.resize(begin.back());
      }
    if (root)
      MPI_Gatherv(own.data(), n_own, MPI_CHAR, bytes.data(), sizes.data(), begin.data(), MPI_CHAR, *root, comm);
    else
      MPI_Allgatherv(own.data(), n_own, MPI_CHAR, bytes.data(), sizes.data(), begin.data(), MPI_CHAR, comm);
  }
} // namespace slipstick::detail
