// The multipliers within given slip bounds as a set: for SMALBE-M, which works with differences from a feasible point.
#pragma once

#include <slipstick/contact/slip_law.h>
#include <slipstick/qp/disc_box.h>

#include <optional>

namespace slipstick::contact
{
  /// @p box about @p center.
  Box shifted(Box box, const tfeti::DistributedVector &center);

  /// The same with discs for friction in space, of the radii that the slip bounds give [N]. Discs without radius are
  /// bounds of 0.
  qp::DiscBox<tfeti::DistributedVector> shifted_discs(const SlipLaw                  &law,
                                                      const std::vector<double>      &slip_bound,
                                                      const Box                      &box,
                                                      const tfeti::DistributedVector &center);

  /// The point within these slip bounds nearest to @p x that balances the loads; in space the one nearest to zero; none
  /// if there is no such point. Collective.
  std::optional<tfeti::DistributedVector> nearest_feasible(const tfeti::DualProblem       &dual,
                                                           const SlipLaw                  &law,
                                                           const std::vector<double>      &slip_bound,
                                                           const tfeti::DistributedVector &x);

  /// center + step; entries that reached a shifted bound are put on the bound itself, to the last bit.
  tfeti::DistributedVector unshifted(const Box                      &box,
                                     const Box                      &shifted,
                                     const tfeti::DistributedVector &center,
                                     const tfeti::DistributedVector &step);
} // namespace slipstick::contact
