// Forces and moments of supports, foundations and contact pairs.
#pragma once

#include <slipstick/contact/held.h>

namespace slipstick::contact
{
  /// On the bodies, by number of supports, behind them foundations: the sums of the reactions, less what obstacles
  /// carry at held nodes (add_held_nodes). The same on all ranks. Collective.
  std::vector<Resultant> reactions(const tfeti::DualProblem                 &dual,
                                   const tfeti::HeldContacts                &held,
                                   const std::vector<std::array<double, 3>> &held_forces,
                                   const tfeti::DistributedVector           &multipliers,
                                   const unsigned int                        n_holders);
} // namespace slipstick::contact
