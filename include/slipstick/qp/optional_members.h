// Optional members of problems, used by the semismooth Newton method (semismooth_newton.h).
#pragma once

#include <vector>

namespace slipstick::qp::detail
{
  /// The member of that name of problems that have it; 0 for others.
  template <typename Problem>
  auto point_stiffness(const Problem &problem, int) -> decltype(problem.point_stiffness())
  {
    return problem.point_stiffness();
  }
  template <typename Problem>
  double point_stiffness(const Problem &, long)
  {
    return 0;
  }

  /// Uses the loose bodies of problems that have them (semismooth_newton.h); other problems have no bodies held by
  /// contact alone.
  template <typename Problem, typename Set>
  auto balance_bodies(const Problem             &problem,
                      const std::vector<double> &stiffness,
                      const Set                 &set,
                      const double               tolerated,
                      std::vector<double>       &moved,
                      int) -> decltype(problem.loose_bodies().balance(stiffness, set, tolerated, moved))
  {
    problem.loose_bodies().balance(stiffness, set, tolerated, moved);
  }
  template <typename Problem, typename Set>
  void balance_bodies(const Problem &,
                      const std::vector<double> &,
                      const Set &,
                      const double,
                      std::vector<double> &,
                      long)
  {}
  template <typename Problem>
  auto bodies_predict_active_sets(const Problem &problem, int) -> decltype(problem.loose_bodies().predict_active_sets())
  {
    return problem.loose_bodies().predict_active_sets();
  }
  template <typename Problem>
  bool bodies_predict_active_sets(const Problem &, long)
  {
    return false;
  }
} // namespace slipstick::qp::detail
