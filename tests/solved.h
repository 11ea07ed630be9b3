// A scene solved from mesh to displacements; a body that slides.
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
      , dual(torn.dual(contact::resolved_options(scene).dual))
      , solution(contact::solve(*dual, contact::slip_bounds(scene, *dual, 1.), contact::resolved_options(scene), {}))
      , u(tfeti::recover(*dual, solution.multipliers, solution.free).u)
    {}

    Torn                                torn;
    std::unique_ptr<tfeti::DualProblem> dual;
    contact::DualSolution               solution;
    std::vector<Eigen::VectorXd>        u;
  };

  /// The box pressed on its circle, held by nothing else, sliding everywhere.
  struct Sliding
  {
    /// @param friction of every node [N].
    Sliding(const Cut &how, const std::string &traction_x, const double friction)
      : torn(cut(scene(traction_x), how))
      , dual(torn.dual())
      , x(dual->particular())
    {
      for (const auto kind : torn.constraints.kind)
        free.push_back(kind != tfeti::RowKind::tangential);
      for (unsigned int r = 0; r < free.size(); ++r)
        if (!free[r])
          x.local_element(r) = friction;
    }

    static Scene scene(const std::string &traction_x)
    {
      Scene scene = box(8);
      touch(scene, 0, "bottom", {5, -20}, 20, "100");
      load(scene, 0, "top", traction_x, "-1");
      return scene;
    }

    const Torn                                torn;
    const std::unique_ptr<tfeti::DualProblem> dual;
    tfeti::DistributedVector                  x; // multipliers
    std::vector<bool>                         free;
  };
} // namespace slipstick::test
