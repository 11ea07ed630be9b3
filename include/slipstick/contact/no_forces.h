// Scenes without loads, whose contact forces are zero: their sets have no forces to be told by.
#pragma once

#include <slipstick/contact/given_bounds.h>

#include <vector>

namespace slipstick::contact
{
  /// Do no loads and no prescribed displacements act on bodies that touch nothing where they are, or, where no slip bound
  /// resists, can be moved to where nothing touches? Then all forces are zero. Collective.
  /// @param feasible forces that balance the loads [N]. @param box bounds of the forces [N]. @param slip_bound of the owned rows [N].
  bool bears_nothing(const tfeti::DualProblem       &dual,
                     const tfeti::DistributedVector &feasible,
                     const Box                      &box,
                     const std::vector<double>      &slip_bound);
} // namespace slipstick::contact
