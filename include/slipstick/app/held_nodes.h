// Contact nodes of a solution that are held by supports.
#pragma once

#include <slipstick/contact/held.h>
#include <slipstick/interface/held_contact.h>

namespace slipstick::app
{
  /// Adds them to the nodes of a solution. Collective.
  template <int dim>
  void add_held_nodes(const scene::Scene<dim>            &scene,
                      const tfeti::DualProblem           &dual,
                      const tfeti::HeldContacts          &held,
                      const tfeti::DistributedVector     &multipliers,
                      const std::vector<Eigen::VectorXd> &u,
                      contact::CheckedContact            &contact);

  /// A warning for every pair with nodes on which an obstacle and a support push in the same direction, so that only
  /// the sum of both forces is determined; keys are "held" and the name of the pair. Collective.
  template <int dim>
  std::map<std::string, std::string> held_node_warnings(const scene::Scene<dim>       &scene,
                                                        const tfeti::HeldContacts     &held,
                                                        const contact::CheckedContact &contact,
                                                        const MPI_Comm                 comm);
} // namespace slipstick::app
