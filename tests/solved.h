// A scene solved from mesh to displacements.
#pragma once

#include "torn.h"

#include <slipstick/contact/friction.h>

namespace slipstick::test
{
  /// A dual problem solved and recovered.
  struct Solved
  {
    explicit Solved(const Scene &scene, const MPI_Comm comm = MPI_COMM_WORLD)
      : torn(scene, comm)
      , dual(torn.dual())
      , solution(contact::solve(*dual, contact::slip_bounds(scene, *dual, 1.), contact::resolved_options(scene), {}))
      , u(dual->recover(solution.multipliers, solution.free).u)
    {}

    Torn                                torn;
    std::unique_ptr<tfeti::DualProblem> dual;
    contact::DualSolution               solution;
    std::vector<Eigen::VectorXd>        u;
  };
} // namespace slipstick::test
