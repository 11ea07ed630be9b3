// Set-up of a process before its work: BLAS, MPI, Trilinos.
#pragma once

#include <memory>

namespace slipstick::tfeti
{
  /// One in main(), before anything else: BLAS on one thread (more would fight with the ranks for the cores), MPI and
  /// Kokkos, without searching for networks that the run does not need. None of them sees the command line. Finalises
  /// MPI when destroyed.
  class Process
  {
  public:
    /// @param n_threads of BLAS.
    /// @param opens_regions whether OpenMP regions (of CHOLMOD) are those of libgomp; else they are calls.
    explicit Process(const unsigned int n_threads = 1, const bool opens_regions = false);
    ~Process();

  private:
    struct Libraries;

    std::unique_ptr<Libraries> libraries;
  };
} // namespace slipstick::tfeti
