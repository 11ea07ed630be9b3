// One run of the program, in this process, and its results as read from the files that it wrote.
#pragma once

#include "problem.h"

#include <slipstick/base/exceptions.h>
#include <slipstick/scene/scene.h>

#include <mpi.h>

namespace slipstick::random
{
  struct RunResult
  {
    ExitStatus         status = ExitStatus::internal_error;
    std::string        message;             // of an error
    Eigen::VectorXd    x, u;                // forces of the rows, displacements, of the untorn problem
    double             copies_differ   = 0; // largest difference of displacement of the copies of a node, relative
    unsigned long long multiplications = 0; // with F
    unsigned int       fallbacks       = 0;
    std::string        worst_check;
    bool               holds_motions = false; // that nothing resists, with a warning
    double             still_load    = 0;     // of the forces that hold them [N]
  };

  /// Solves @p scene with app::run in @p directory, which is overwritten. Displacements come from the .vtu files (single
  /// precision), forces from contact.csv (double).
  RunResult run(const scene::Scene<2> &scene,
                const Problem         &problem,
                const std::string     &directory,
                const MPI_Comm         comm);
} // namespace slipstick::random
