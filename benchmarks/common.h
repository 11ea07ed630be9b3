// What the C++ benchmarks share: their command line and medians of times.
#pragma once

#include <slipstick/tfeti/process.h>

#include <deal.II/base/mpi.h>

#include <algorithm>
#include <functional>
#include <iostream>
#include <stdexcept>
#include <string>
#include <vector>

namespace slipstick::benchmark
{
  inline double median(std::vector<double> values)
  {
    std::nth_element(values.begin(), values.begin() + values.size() / 2, values.end());
    return values[values.size() / 2];
  }

  /// Wall time of the slowest rank [s].
  inline double seconds(const MPI_Comm comm, const std::function<void()> &work)
  {
    MPI_Barrier(comm);
    const double start = MPI_Wtime();
    work();
    return dealii::Utilities::MPI::max(MPI_Wtime() - start, comm);
  }

  /// CASE.prm [REPETITIONS] [--set Section/Name=value]...
  struct Case
  {
    std::string              file;
    unsigned int             repetitions;
    std::vector<std::string> overrides;
  };

  /// Starts MPI with one thread, reads the command line of the program @p name, calls @p run.
  /// @return what it returns; an error ends all ranks with status 2.
  inline int main_of(const std::string                      &name,
                     int                                     argc,
                     char                                  **argv,
                     const unsigned int                      default_repetitions,
                     const std::function<int(const Case &)> &run)
  {
    tfeti::Process process;
    Case           given{"", default_repetitions, {}};
    try
      {
        for (int i = 1; i < argc; ++i)
          if (std::string(argv[i]) == "--set" && i + 1 < argc)
            given.overrides.push_back(argv[++i]);
          else if (given.file.empty())
            given.file = argv[i];
          else
            given.repetitions = std::stoul(argv[i]);
        if (given.file.empty() || given.repetitions == 0)
          throw std::runtime_error("usage: " + name + " CASE.prm [REPETITIONS] [--set Section/Name=value]...");
        return run(given);
      }
    catch (const std::exception &error)
      {
        std::cerr << name << ": " << error.what() << std::endl;
        MPI_Abort(MPI_COMM_WORLD, 2);
      }
    return 2;
  }
} // namespace slipstick::benchmark
