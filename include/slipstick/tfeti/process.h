// Initialisation of a process: BLAS, MPI, Trilinos.
#pragma once

#include <memory>

namespace slipstick::tfeti
{
  /// Create one in main() before anything else: sets BLAS to one thread (more would compete with the ranks for the
  /// cores) and initialises MPI and Kokkos without searching for networks that the run does not need. None of these
  /// libraries sees the command line. Finalises MPI when destroyed.
  class Process
  {
  public:
    /// @param n_threads number of BLAS threads.
    /// @param opens_regions true: OpenMP regions (of CHOLMOD) are run by libgomp; false: they are executed as plain
    /// calls.
    explicit Process(const unsigned int n_threads = 1, const bool opens_regions = false);
    ~Process();

  private:
    struct Libraries;

    std::unique_ptr<Libraries> libraries;
  };
} // namespace slipstick::tfeti
