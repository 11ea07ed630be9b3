// Detection of scenes without loads, in which all contact forces vanish.
#pragma once

#include <slipstick/contact/given_bounds.h>

#include <vector>

namespace slipstick::contact
{
  /// Whether all forces are zero because there are no loads, no prescribed displacements and no slip in earlier steps
  /// (after which friction may lock forces in), and the bodies either touch nothing in their initial position or, where
  /// no slip bound acts, can be moved apart. Collective.
  /// @param feasible forces that balance the loads [N]. @param box bounds of the forces [N]. @param slip_bound of the
  /// owned rows [N].
  bool all_forces_vanish(const tfeti::DualProblem       &dual,
                         const tfeti::DistributedVector &feasible,
                         const Box                      &box,
                         const std::vector<double>      &slip_bound);
} // namespace slipstick::contact
