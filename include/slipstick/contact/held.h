// Contact nodes whose gap is prescribed by supports: their contact forces follow from the reactions.
#pragma once

#include <slipstick/contact/checks.h>

namespace slipstick::contact
{
  /// Gaps [mm] of the points after loading, in their order: the prescribed ones where supports alone prescribe them,
  /// otherwise from the displacement.
  /// Collective.
  std::vector<double> gaps_of(const tfeti::HeldContacts &held, const std::vector<Eigen::VectorXd> &u);

  /// Appends the held nodes to those of @p contact, with the force from the other side; a node that already exists
  /// because of its friction row is completed instead. The force of a bond is its share of the reactions; where both a
  /// support and an obstacle hold the node, the compressive part of the reaction is shared equally among all that hold
  /// it. Between two bodies the force is 0: the supports take all of it.
  /// @param gaps as returned by gaps_of(). @param touches for every point: whether it is closed.
  /// @param sticks for every point: whether its law has friction.
  void add_held_nodes(const tfeti::DualProblem       &dual,
                      const tfeti::HeldContacts      &held,
                      const tfeti::DistributedVector &multipliers,
                      const std::vector<double>      &gaps,
                      const std::vector<bool>        &touches,
                      const std::vector<bool>        &sticks,
                      CheckedContact                 &contact);
} // namespace slipstick::contact
