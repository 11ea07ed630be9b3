#include <slipstick/app/held_nodes.h>
#include <slipstick/app/run_summary.h>
#include <slipstick/base/log.h>

#include <deal.II/base/mpi.h>

#include <algorithm>
#include <cmath>
#include <map>

namespace slipstick::app
{
  namespace
  {
    // Relative to the forces of a pair: smaller forces at held nodes, e.g. at a single corner node, do not justify a
    // warning.
    constexpr double part_that_counts = 0.05;
  } // namespace

  template <int dim>
  void add_held_nodes(const scene::Scene<dim>            &scene,
                      const tfeti::DualProblem           &dual,
                      const tfeti::HeldContacts          &held,
                      const tfeti::DistributedVector     &multipliers,
                      const std::vector<Eigen::VectorXd> &u,
                      contact::CheckedContact            &contact)
  {
    const auto   gaps  = contact::gaps_of(held, u);
    const double noise = check_limit(scene.solver.tolerance) * contact.checks.max_displacement;
    interface::refuse_held_penetration(scene, held, gaps, noise, dual.communicator());
    std::vector<bool> touches, sticks;
    for (unsigned int i = 0; i < held.points.size(); ++i)
      {
        const auto &point = held.points[i];
        touches.push_back(point.is_bonded ||
                          gaps[i] <= interface::held_contact_tolerance(point) + (point.is_known ? 0. : noise));
        sticks.push_back(scene.contacts[point.contact.pair].law.has_tangential_row());
      }
    contact::add_held_nodes(dual, held, multipliers, gaps, touches, sticks, contact);
  }

  template <int dim>
  std::map<std::string, std::string> held_node_warnings(const scene::Scene<dim>       &scene,
                                                        const tfeti::HeldContacts     &held,
                                                        const contact::CheckedContact &contact,
                                                        const MPI_Comm                 comm)
  {
    std::vector<double> forces(scene.contacts.size()), all(scene.contacts.size());
    for (const auto &node : contact.nodes)
      all[node.pair] += std::abs(node.pressure) * node.area;
    for (unsigned int i = 0; i < held.points.size(); ++i)
      if (!held.points[i].is_bonded)
        forces[held.points[i].contact.pair] +=
          dim == 2 ? std::hypot(contact.held_forces[i][0], contact.held_forces[i][1])
                   : std::hypot(contact.held_forces[i][0], contact.held_forces[i][1], contact.held_forces[i][2]);
    std::map<std::string, std::string> texts;
    for (unsigned int k = 0; k < scene.contacts.size(); ++k)
      if (const double force = dealii::Utilities::MPI::sum(forces[k], comm);
          force > part_that_counts * dealii::Utilities::MPI::sum(all[k], comm))
        texts["held " + scene.contacts[k].name] = format(
          "Contact %s: supports and contact act at the same nodes, so that only the sum of both forces there is "
          "determined; %.4g N of it, an equal share, are counted as contact (without friction under Coulomb's law); "
          "leave the supported boundary out of the contact, or free the support along the normal",
          scene.contacts[k].name.c_str(),
          force);
    return texts;
  }

  template void                               add_held_nodes(const scene::Scene<2> &,
                                                             const tfeti::DualProblem &,
                                                             const tfeti::HeldContacts &,
                                                             const tfeti::DistributedVector &,
                                                             const std::vector<Eigen::VectorXd> &,
                                                             contact::CheckedContact &);
  template std::map<std::string, std::string> held_node_warnings(const scene::Scene<2> &,
                                                                 const tfeti::HeldContacts &,
                                                                 const contact::CheckedContact &,
                                                                 const MPI_Comm);
  template void                               add_held_nodes(const scene::Scene<3> &,
                                                             const tfeti::DualProblem &,
                                                             const tfeti::HeldContacts &,
                                                             const tfeti::DistributedVector &,
                                                             const std::vector<Eigen::VectorXd> &,
                                                             contact::CheckedContact &);
  template std::map<std::string, std::string> held_node_warnings(const scene::Scene<3> &,
                                                                 const tfeti::HeldContacts &,
                                                                 const contact::CheckedContact &,
                                                                 const MPI_Comm);
} // namespace slipstick::app
