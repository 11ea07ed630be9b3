#include <slipstick/contact/held.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>

namespace slipstick::contact
{
  namespace
  {
    using Components = std::array<double, 3>; // x, y, z

    double product(const Components &a, const Components &b)
    {
      return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
    }

    /// Force on a contact node [N].
    Components force_on(const tfeti::HeldContacts::Point &point,
                        const tfeti::Constraints         &constraints,
                        const tfeti::DistributedVector   &multipliers)
    {
      Components             force{{0, 0, 0}};
      std::set<unsigned int> holders;
      for (const unsigned int r : point.reactions)
        {
          const auto &reaction = constraints.reactions[r];
          const auto &by       = reaction.holders;
          if (point.is_bonded && std::find(by.begin(), by.end(), point.holder) == by.end())
            continue;
          holders.insert(by.begin(), by.end());
          const double share = point.is_bonded ? 1. / by.size() : 1.;
          for (unsigned int d = 0; d < 3; ++d)
            force[d] -= share * multipliers.local_element(reaction.row) * reaction.direction[d];
        }
      if (point.is_bonded)
        return force;
      const double pushing = std::max(0., -product(force, point.contact.normal));
      const double shared  = pushing / (holders.size() + 1);
      for (unsigned int d = 0; d < 3; ++d)
        force[d] = -shared * point.contact.normal[d];
      return force;
    }
  } // namespace

  std::vector<double> gaps_of(const tfeti::HeldContacts &held, const std::vector<Eigen::VectorXd> &u)
  {
    std::vector<double> gaps = held.gaps.c;
    if (held.gaps.rows->size() == 0)
      return gaps;
    tfeti::DistributedVector closing(held.gaps.rows);
    for (unsigned int p = 0; p < u.size(); ++p)
      for (const auto &entry : held.gaps.blocks[p])
        closing.local_element(entry.row) += entry.value * u[p][entry.dof];
    closing.compress(dealii::VectorOperation::add);
    for (unsigned int i = 0; i < gaps.size(); ++i)
      gaps[i] -= held.points[i].is_known ? held.points[i].closing : closing.local_element(i);
    return gaps;
  }

  void add_held_nodes(const tfeti::DualProblem       &dual,
                      const tfeti::HeldContacts      &held,
                      const tfeti::DistributedVector &multipliers,
                      const std::vector<double>      &gaps,
                      const std::vector<bool>        &touches,
                      const std::vector<bool>        &sticks,
                      CheckedContact                 &contact)
  {
    for (unsigned int i = 0; i < held.points.size(); ++i)
      {
        const auto      &point     = held.points[i];
        const bool       has_place = point.place != tfeti::invalid_row;
        ContactNode      node      = has_place ? contact.nodes[point.place] : node_at(point.contact);
        const Components force = touches[i] ? force_on(point, dual.constraints(), multipliers) : Components{{0, 0, 0}};
        node.is_closed         = touches[i];
        node.gap               = gaps[i];
        node.pressure          = (0. - product(force, node.normal)) / node.area; // the sum avoids -0
        if (point.is_bonded)
          {
            node.tangential_traction = product(force, {{-node.normal[1], node.normal[0], 0}}) / node.area;
            if (point.contact.is_in_space())
              {
                for (unsigned int d = 0; d < 3; ++d)
                  node.traction[d] = force[d] / node.area + node.pressure * node.normal[d];
                node.tangential_traction = std::sqrt(product(node.traction, node.traction));
              }
            node.slip_bound = std::numeric_limits<double>::infinity();
          }
        if (!has_place)
          node.status = !touches[i] ? ContactStatus::open : sticks[i] ? ContactStatus::stick : ContactStatus::slip;
        contact.held_forces.push_back(force);
        if (has_place)
          contact.nodes[point.place] = node;
        else
          {
            contact.nodes.push_back(node);
            contact.keys.push_back(point.contact.key);
          }
      }
  }
} // namespace slipstick::contact
