// What problems may have and semismooth Newton uses (semismooth_newton.h).
#pragma once

#include <algorithm>
#include <vector>

namespace slipstick::qp::detail
{
  // s of the natural map over the stiffness of a point whose neighbours are held: they yield with it, and the diagonal of
  // F is some ten times the inverse of that stiffness (doc/decisions/0090).
  constexpr double yielding_neighbours = 0.1;

  /// s times the norm of F, of an entry of weight 1: by the stiffness of single points, where the problem tells it, but never
  /// less than bodies need.
  template <typename Problem>
  auto step_of_points(const Problem &problem, const double least, int) -> decltype(problem.point_stiffness())
  {
    return std::max(least, yielding_neighbours * problem.point_stiffness());
  }
  template <typename Problem>
  double step_of_points(const Problem &, const double least, long)
  {
    return least;
  }

  /// What loose bodies of problems do that have them (semismooth_newton.h); others have no bodies that contact alone holds.
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
  auto bodies_tell_sets(const Problem &problem, int) -> decltype(problem.loose_bodies().tell_sets())
  {
    return problem.loose_bodies().tell_sets();
  }
  template <typename Problem>
  bool bodies_tell_sets(const Problem &, long)
  {
    return false;
  }
} // namespace slipstick::qp::detail
