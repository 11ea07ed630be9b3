#include <slipstick/contact/contact_nodes.h>
#include <slipstick/contact/node_law.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace slipstick::contact
{
  namespace
  {
    using tfeti::DistributedVector;

    /// Moment of the contact forces on both sides: the force on the slave body acts at the mean of the slave nodes, the
    /// opposite force at that of the master nodes.
    /// @param N compressive force. @param T minus the tangential force on the slave body, in the plane.
    std::array<double, 3> moment_mismatch(const tfeti::ContactPoint &point,
                                          const ContactNode         &node,
                                          const double               N,
                                          const double               T)
    {
      if (!point.has_master || point.rotates)
        return {{0, 0, 0}};
      std::array<double, 3> force{
        {-(N * point.normal[0] - T * point.normal[1]), -(N * point.normal[1] + T * point.normal[0]), 0}};
      if (point.is_in_space())
        for (unsigned int d = 0; d < 3; ++d)
          force[d] = node.traction[d] * node.area - N * point.normal[d];
      std::array<double, 3> apart;
      for (unsigned int d = 0; d < 3; ++d)
        apart[d] = point.slave_position[d] - point.master_position[d];
      Resultant mismatch;
      mismatch.add<3>(force, apart);
      return mismatch.moment;
    }

    /// Sets vectors and magnitudes of tangential traction and slip.
    void complete_in_space(const tfeti::DualProblem  &dual,
                           const tfeti::ContactPoint &point,
                           const DistributedVector   &multipliers,
                           const DistributedVector   &jumps,
                           ContactNode               &node)
    {
      for (const unsigned int k : {0, 1})
        {
          const unsigned int row = k == 0 ? point.tangential_row : point.second_row;
          if (row == tfeti::invalid_row) // a support holds the node in this direction
            continue;
          for (unsigned int d = 0; d < 3; ++d)
            {
              node.traction[d] -= multipliers.local_element(row) / node.area * point.tangents[k][d];
              node.slip_vector[d] += (jumps.local_element(row) - dual.constraints().c[row]) * point.tangents[k][d];
            }
        }
      node.tangential_traction = std::hypot(node.traction[0], node.traction[1], node.traction[2]);
      node.slip                = std::hypot(node.slip_vector[0], node.slip_vector[1], node.slip_vector[2]);
    }
  } // namespace

  ContactNode node_at(const tfeti::ContactPoint &point)
  {
    ContactNode node;
    node.pair        = point.pair;
    node.position    = point.position;
    node.acts_at     = point.slave_position;
    node.normal      = point.normal;
    node.area        = point.traction_area;
    node.length      = point.length;
    node.initial_gap = point.gap;
    return node;
  }

  ContactNode contact_node(const tfeti::DualProblem       &dual,
                           const tfeti::ContactPoint      &point,
                           const tfeti::DistributedVector &multipliers,
                           const tfeti::DistributedVector &jumps,
                           const std::vector<double>      &slip_bound,
                           const std::vector<bool>        &free,
                           const double                    noise)
  {
    ContactNode node = node_at(point);
    if (point.normal_row != tfeti::invalid_row)
      {
        node.pressure = multipliers.local_element(point.normal_row) / node.area;
        node.gap      = dual.constraints().c[point.normal_row] - jumps.local_element(point.normal_row);
      }
    node.is_closed    = point.normal_row == tfeti::invalid_row || free[point.normal_row];
    node.status       = status_of(node.is_closed, 0., point.is_held_across);
    double tangential = 0;
    if (point.tangential_row != tfeti::invalid_row)
      {
        tangential               = multipliers.local_element(point.tangential_row);
        node.tangential_traction = -tangential / node.area; // on the slave body
        node.slip       = jumps.local_element(point.tangential_row) - dual.constraints().c[point.tangential_row];
        node.slip_bound = slip_bound[point.tangential_row] / node.area;
        // free rows of a node without force may hold a motion that nothing else resists
        if (free[point.tangential_row] && node.slip_bound == 0 && node.pressure * node.area <= noise)
          node.is_closed = false;
        node.status = status_of(node.is_closed, node.slip_bound, free[point.tangential_row]);
      }
    if (point.is_in_space())
      complete_in_space(dual, point, multipliers, jumps, node);
    node.moment_mismatch = moment_mismatch(point, node, node.pressure * node.area, tangential);
    return node;
  }

  ContactNode bonded_node(const tfeti::DualProblem       &dual,
                          const tfeti::ContactPoint      &point,
                          const tfeti::DistributedVector &multipliers,
                          const tfeti::DistributedVector &jumps)
  {
    ContactNode node  = node_at(point);
    node.status       = ContactStatus::stick;
    node.is_closed    = true;
    node.slip_bound   = std::numeric_limits<double>::infinity();
    node.gap          = point.gap;
    double tangential = 0;
    if (point.normal_row != tfeti::invalid_row)
      {
        node.pressure = multipliers.local_element(point.normal_row) / node.area;
        node.gap -= jumps.local_element(point.normal_row);
      }
    if (point.tangential_row != tfeti::invalid_row)
      {
        tangential               = multipliers.local_element(point.tangential_row);
        node.tangential_traction = -tangential / node.area;
        node.slip                = jumps.local_element(point.tangential_row);
      }
    if (point.is_in_space())
      complete_in_space(dual, point, multipliers, jumps, node);
    node.moment_mismatch = moment_mismatch(point, node, node.pressure * node.area, tangential);
    return node;
  }

  ContactNode part_of(const ContactNode &whole, const tfeti::ContactPoint &point)
  {
    if (point.share == 1 && point.tangential_share == 1)
      return whole;
    ContactNode  part = whole;
    const double more = point.share > 0 ? point.tangential_share / point.share : 0.; // of the tangential traction
    part.pair         = point.pair;
    part.length       = point.length;
    part.area *= point.share;
    part.tangential_traction *= more;
    for (double &component : part.traction)
      component *= more;
    if (std::isfinite(part.slip_bound))
      part.slip_bound *= more;
    for (double &component : part.moment_mismatch)
      component *= point.share;
    if (more == 0) // frictionless
      part.status = status_of(part.is_closed, 0., false);
    return part;
  }

  std::vector<PairResult> pair_results(const std::vector<ContactNode> &nodes,
                                       const std::vector<std::string> &pair_names,
                                       const unsigned int              dim)
  {
    std::vector<PairResult> results(pair_names.size());
    for (unsigned int k = 0; k < pair_names.size(); ++k)
      results[k].pair = pair_names[k];
    for (const auto &node : nodes)
      {
        PairResult &result = results[node.pair];
        result.normal_force += node.pressure * node.area;
        result.tangential_force += node.tangential_traction * node.area;
        const double          N = node.pressure * node.area, T = node.tangential_traction * node.area;
        std::array<double, 3> force{
          {-N * node.normal[0] - T * node.normal[1], -N * node.normal[1] + T * node.normal[0], 0}};
        for (unsigned int d = 0; d < 3; ++d)
          {
            result.moment_mismatch[d] += node.moment_mismatch[d];
            if (dim == 3)
              force[d] = node.traction[d] * node.area - N * node.normal[d];
          }
        result.on_slave.add<3>(force, node.acts_at);
        result.max_pressure = std::max(result.max_pressure, node.pressure);
        result.norm.pressure += node.pressure * node.pressure * node.area;
        result.norm.tangential += node.tangential_traction * node.tangential_traction * node.area;
        result.contact_length += node.is_closed ? node.length : 0.;
        result.contact_nodes += node.is_closed;
        result.open_nodes += !node.is_closed;
        result.slip_nodes += node.status == ContactStatus::slip;
        result.open_slip_nodes += node.status == ContactStatus::slip && !node.is_closed;
        result.stick_nodes += node.status == ContactStatus::stick;
      }
    for (auto &result : results)
      result.norm = {std::sqrt(result.norm.pressure), std::sqrt(result.norm.tangential)};
    return results;
  }
} // namespace slipstick::contact
