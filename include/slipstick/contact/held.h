// Contact nodes whose gap is prescribed by supports: contact forces derived from the reactions there.
#pragma once

#include <slipstick/contact/checks.h>

namespace slipstick::contact
{
  /// Gaps [mm] of the points after loading, in their order: as prescribed by supports, otherwise from the displacement.
  /// Collective.
  std::vector<double> gaps_of(const tfeti::HeldContacts &held, const std::vector<Eigen::VectorXd> &u);

  /// Appends the held nodes to those of @p contact, with the force of the other side; where friction has made a row of
  /// one, completes the node there. The force of a bond is its share of the reactions; where a support and an obstacle
  /// agree, the compressive part of the reaction is shared equally among all that hold the node. Between two bodies the
  /// force is 0: the supports take all of it.
  /// @param gaps as gaps_of() says, @param touches of every point: is it closed?
  /// @param sticks of every point: does its law have friction?
  void add_held_nodes(const tfeti::DualProblem       &dual,
                      const tfeti::HeldContacts      &held,
                      const tfeti::DistributedVector &multipliers,
                      const std::vector<double>      &gaps,
                      const std::vector<bool>        &touches,
                      const std::vector<bool>        &sticks,
                      CheckedContact                 &contact);
} // namespace slipstick::contact
