// Contact nodes of the answer: pressure, traction, gap, slip and status.
#pragma once

#include <slipstick/contact/result.h>
#include <slipstick/tfeti/dual_problem.h>

namespace slipstick::contact
{
  /// What the rows do not contain about a contact node: its place.
  ContactNode node_at(const tfeti::ContactPoint &point);

  /// One contact node from the force on it and the jump of displacement there.
  ContactNode contact_node(const tfeti::DualProblem       &dual,
                           const tfeti::ContactPoint      &point,
                           const tfeti::DistributedVector &multipliers,
                           const tfeti::DistributedVector &jumps,
                           const std::vector<double>      &slip_bound,
                           const std::vector<bool>        &free);

  /// One node of a bonded pair: it sticks whatever the tractions; a row that others imply carries none.
  ContactNode bonded_node(const tfeti::DualProblem       &dual,
                          const tfeti::ContactPoint      &point,
                          const tfeti::DistributedVector &multipliers,
                          const tfeti::DistributedVector &jumps);

  /// Sums over the nodes of all pairs, from the nodes of all ranks.
  std::vector<PairResult> pair_results(const std::vector<ContactNode> &nodes,
                                       const std::vector<std::string> &pair_names,
                                       const unsigned int              dim = 2);
} // namespace slipstick::contact
