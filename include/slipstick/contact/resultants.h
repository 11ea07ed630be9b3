// Forces and moments of supports, foundations and contact pairs.
#pragma once

#include <slipstick/contact/held.h>

namespace slipstick::contact
{
  /// Forces on the bodies from supports, followed by foundations: sums of the reactions, without the part carried by
  /// obstacles at held nodes (add_held_nodes). The same on all ranks. Collective.
  std::vector<Resultant> reactions(const tfeti::DualProblem                 &dual,
                                   const tfeti::HeldContacts                &held,
                                   const std::vector<std::array<double, 3>> &held_forces,
                                   const tfeti::DistributedVector           &multipliers,
                                   const unsigned int                        n_holders);
} // namespace slipstick::contact
