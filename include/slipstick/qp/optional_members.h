// Optional members of problems, used by the semismooth Newton method (semismooth_newton.h).
#pragma once

#include <algorithm>
#include <vector>

namespace slipstick::qp::detail
{
  /// s times the norm of F, for an entry of weight 1: from the stiffness of single points if the problem provides it,
  /// but never less than the value for whole bodies.
  template <typename Problem>
  auto natural_map_scale(const Problem &problem, const double least, int) -> decltype(problem.point_stiffness())
  {
    return std::max(least, problem.point_stiffness());
  }
  template <typename Problem>
  double natural_map_scale(const Problem &, const double least, long)
  {
    return least;
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
