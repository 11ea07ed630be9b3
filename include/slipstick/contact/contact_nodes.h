// Contact nodes of the solution: pressure, traction, gap, slip and status.
#pragma once

#include <slipstick/contact/result.h>
#include <slipstick/tfeti/dual_problem.h>

namespace slipstick::contact
{
  /// A contact node with the data that do not depend on the solution: pair, position, normal, areas and initial gap.
  ContactNode node_at(const tfeti::ContactPoint &point);

  /// A contact node from its contact force and displacement jump. @param noise forces up to this are rounding.
  ContactNode contact_node(const tfeti::DualProblem       &dual,
                           const tfeti::ContactPoint      &point,
                           const tfeti::DistributedVector &multipliers,
                           const tfeti::DistributedVector &jumps,
                           const std::vector<double>      &slip_bound,
                           const std::vector<bool>        &free,
                           const double                    noise);

  /// A node of a bonded pair: it sticks whatever its tractions; a row that is implied by others carries no traction.
  ContactNode bonded_node(const tfeti::DualProblem       &dual,
                          const tfeti::ContactPoint      &point,
                          const tfeti::DistributedVector &multipliers,
                          const tfeti::DistributedVector &jumps);

  /// The part of a node's forces that belongs to the pair of @p point: @p whole if there is no other pair.
  ContactNode part_of(const ContactNode &whole, const tfeti::ContactPoint &point);

  /// Results of all pairs, summed over the nodes of all ranks.
  std::vector<PairResult> pair_results(const std::vector<ContactNode> &nodes,
                                       const std::vector<std::string> &pair_names,
                                       const unsigned int              dim = 2);
} // namespace slipstick::contact
