// The admissible set for given slip bounds, for SMALBE-M, which works with differences from a feasible point.
#pragma once

#include <slipstick/contact/slip_law.h>
#include <slipstick/qp/disc_box.h>

#include <optional>

namespace slipstick::contact
{
  /// Bounds of x - center for x within @p box.
  Box shifted(Box box, const tfeti::DistributedVector &center);

  /// As shifted(), plus discs for friction in space with radii equal to the slip bounds [N]. Discs of radius 0 become
  /// bounds of 0.
  qp::DiscBox<tfeti::DistributedVector> shifted_discs(const SlipLaw                  &law,
                                                      const std::vector<double>      &slip_bound,
                                                      const Box                      &box,
                                                      const tfeti::DistributedVector &center);

  /// The point within these slip bounds nearest to @p x that balances the loads (in space the one nearest to zero);
  /// nothing if there is no such point. Collective.
  std::optional<tfeti::DistributedVector> nearest_feasible(const tfeti::DualProblem       &dual,
                                                           const SlipLaw                  &law,
                                                           const std::vector<double>      &slip_bound,
                                                           const tfeti::DistributedVector &x);

  /// center + step; entries at a shifted bound are set exactly to the original bound.
  tfeti::DistributedVector unshifted(const Box                      &box,
                                     const Box                      &shifted,
                                     const tfeti::DistributedVector &center,
                                     const tfeti::DistributedVector &step);
} // namespace slipstick::contact
