#include <slipstick/contact/checks.h>

#include <deal.II/base/mpi.h>

#include <cmath>
#include <limits>

namespace slipstick::contact
{
  namespace
  {
    using tfeti::DistributedVector;

    // Displacements below this part of the largest gap count as none.
    constexpr double negligible_part_of_gap = 1e-3;

    double relative(const double value, const double scale)
    {
      return scale > 0 ? value / scale : value;
    }

    /// Nodal forces K u - f of every subdomain: what supports, contact and neighbours exert.
    std::vector<Eigen::VectorXd> nodal_forces(const tfeti::DualProblem &dual, const std::vector<Eigen::VectorXd> &u)
    {
      std::vector<Eigen::VectorXd> forces;
      for (unsigned int p = 0; p < u.size(); ++p)
        forces.push_back(dual.subdomains()[p]->apply_stiffness(u[p]) - dual.subdomains()[p]->load());
      return forces;
    }

    /// Forces and moments left on the bodies and nodes by K u - f + B'x, and the force scales.
    struct Balance
    {
      Eigen::MatrixXd left;             // motions x bodies
      Eigen::VectorXd scale;            // by body: sum of the magnitudes of all outside forces
      double          largest_left = 0; // nodal
      double          largest      = 0; // nodal: largest load, contact force or reaction
    };

    Balance balance(const tfeti::DualProblem           &dual,
                    const std::vector<Eigen::VectorXd> &nodal_forces,
                    const DistributedVector            &multipliers,
                    const unsigned int                  n_bodies)
    {
      DistributedVector outside = multipliers; // what does not act between the subdomains of a body
      for (unsigned int r = 0; r < dual.constraints().kind.size(); ++r)
        if (dual.constraints().kind[r] == tfeti::RowKind::gluing)
          outside.local_element(r) = 0;
      const auto all = dual.forces(multipliers), of_outside = dual.forces(outside);

      const unsigned int k =
        dealii::Utilities::MPI::max(dual.subdomains().empty()
                                      ? 0u
                                      : static_cast<unsigned int>(dual.subdomains()[0]->kernel().cols()),
                                    dual.communicator());
      Balance result{Eigen::MatrixXd::Zero(k, n_bodies), Eigen::VectorXd::Zero(n_bodies)};
      for (unsigned int p = 0; p < nodal_forces.size(); ++p)
        {
          const auto           &system = *dual.subdomains()[p];
          const Eigen::VectorXd left   = nodal_forces[p] + all[p];
          result.scale[system.body()] += system.load().cwiseAbs().sum() + of_outside[p].cwiseAbs().sum();
          result.largest =
            std::max({result.largest, system.load().cwiseAbs().maxCoeff(), of_outside[p].cwiseAbs().maxCoeff()});
          result.left.col(system.body()) += system.body_modes().transpose() * (system.kernel().transpose() * left);
          result.largest_left = std::max(result.largest_left, left.cwiseAbs().maxCoeff());
        }
      MPI_Allreduce(MPI_IN_PLACE, result.left.data(), result.left.size(), MPI_DOUBLE, MPI_SUM, dual.communicator());
      MPI_Allreduce(MPI_IN_PLACE, result.scale.data(), result.scale.size(), MPI_DOUBLE, MPI_SUM, dual.communicator());
      result.largest_left = dealii::Utilities::MPI::max(result.largest_left, dual.communicator());
      result.largest      = dealii::Utilities::MPI::max(result.largest, dual.communicator());
      return result;
    }

    /// Moment of the forces on both sides: force on the slave body at its node, the opposite one at the mean of the
    /// master nodes; two dimensions.
    /// @param N pressing force, @param T minus the tangential force on the slave body.
    double moment_mismatch(const tfeti::ContactPoint &point, const double N, const double T)
    {
      if (!point.has_master)
        return 0;
      const double fx = -(N * point.normal[0] - T * point.normal[1]), fy = -(N * point.normal[1] + T * point.normal[0]);
      return (point.position[0] - point.master_position[0]) * fy - (point.position[1] - point.master_position[1]) * fx;
    }

    ContactNode node_at(const tfeti::ContactPoint &point)
    {
      ContactNode node;
      node.pair     = point.pair;
      node.position = point.position;
      node.normal   = point.normal;
      node.area     = point.traction_area;
      node.length   = point.length;
      return node;
    }

    /// What a row at a bound does that the law does not allow [mm]: penetration; slip that the friction drives.
    /// @param jump B u - c, @param x multiplier, @param bound of it, if tangential.
    double inadmissible_jump(const tfeti::RowKind kind, const double jump, const double x, const double bound)
    {
      if (kind == tfeti::RowKind::tangential && bound == 0)
        return 0;
      return kind == tfeti::RowKind::tangential && x > 0 ? std::min(jump, 0.) : std::max(jump, 0.);
    }

    /// One contact node from the force on it and the jump of displacement there.
    ContactNode contact_node(const tfeti::DualProblem  &dual,
                             const tfeti::ContactPoint &point,
                             const DistributedVector   &multipliers,
                             const DistributedVector   &jumps,
                             const std::vector<double> &slip_bound,
                             const std::vector<bool>   &free)
    {
      ContactNode node = node_at(point);
      if (point.normal_row != tfeti::invalid_row)
        {
          node.pressure = multipliers.local_element(point.normal_row) / node.area;
          node.gap      = dual.constraints().c[point.normal_row] - jumps.local_element(point.normal_row);
        }
      node.is_closed    = point.normal_row == tfeti::invalid_row || free[point.normal_row];
      node.status       = node.is_closed ? ContactStatus::stick : ContactStatus::open;
      double tangential = 0;
      if (point.tangential_row == tfeti::invalid_row)
        {
          // without friction what touches is free to slide
          if (node.is_closed)
            node.status = ContactStatus::slip;
        }
      else
        {
          tangential               = multipliers.local_element(point.tangential_row);
          node.tangential_traction = -tangential / node.area; // on the slave body
          node.slip       = jumps.local_element(point.tangential_row) - dual.constraints().c[point.tangential_row];
          node.slip_bound = slip_bound[point.tangential_row] / node.area;
          // a bound that acts on open nodes too (Tresca on the whole boundary) makes them slip as well
          if (!free[point.tangential_row] && (node.slip_bound > 0 || node.is_closed))
            node.status = ContactStatus::slip;
        }
      node.moment_mismatch = moment_mismatch(point, node.pressure * node.area, tangential);
      return node;
    }

    /// One node of a bonded pair: it sticks whatever the tractions; a row that others imply carries none.
    ContactNode bonded_node(const tfeti::ContactPoint &point,
                            const DistributedVector   &multipliers,
                            const DistributedVector   &jumps)
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
      node.moment_mismatch = moment_mismatch(point, node.pressure * node.area, tangential);
      return node;
    }
  } // namespace

  std::pair<std::string, double> Checks::worst() const
  {
    return std::max<std::pair<std::string, double>>({{"interface jump", interface_jump},
                                                     {"penetration", penetration},
                                                     {"complementarity", complementarity},
                                                     {"tension in contact", tension},
                                                     {"friction bound", friction_bound},
                                                     {"equilibrium of a node", nodal_equilibrium},
                                                     {"force balance", force_balance},
                                                     {"moment balance", moment_balance}},
                                                    [](const auto &a, const auto &b) {
                                                      // a number that is none is the worst of all
                                                      return !std::isnan(a.second) &&
                                                             (std::isnan(b.second) || a.second < b.second);
                                                    });
  }

  CheckedContact check(const tfeti::DualProblem           &dual,
                       const DistributedVector            &multipliers,
                       const std::vector<Eigen::VectorXd> &u,
                       const std::vector<double>          &slip_bound,
                       const std::vector<bool>            &free,
                       const unsigned int                  n_bodies)
  {
    const MPI_Comm comm        = dual.communicator();
    const auto    &constraints = dual.constraints();
    const auto     jumps       = dual.jumps(u);
    const auto     forces      = nodal_forces(dual, u);
    CheckedContact result;
    Checks        &checks = result.checks;

    for (unsigned int p = 0; p < u.size(); ++p)
      {
        // two components a node
        checks.max_displacement =
          std::max(checks.max_displacement,
                   Eigen::Map<const Eigen::Matrix2Xd>(u[p].data(), 2, u[p].size() / 2).colwise().norm().maxCoeff());
        checks.energy += u[p].dot(forces[p] + dual.subdomains()[p]->load());
      }
    const auto violation = [&](const unsigned int r) {
      const double compliance = constraints.compliance.empty() ? 0. : constraints.compliance[r];
      return jumps.local_element(r) - constraints.c[r] - compliance * multipliers.local_element(r);
    };
    for (unsigned int r = 0; r < constraints.kind.size(); ++r)
      if (is_equality(constraints.kind[r]))
        checks.interface_jump = std::max(checks.interface_jump, std::abs(violation(r)));
    DistributedVector wrong = jumps;
    std::vector<bool> held(constraints.kind.size());
    for (unsigned int r = 0; r < held.size(); ++r)
      {
        wrong.local_element(r) =
          free[r] ? violation(r)
                  : inadmissible_jump(constraints.kind[r], violation(r), multipliers.local_element(r), slip_bound[r]);
        held[r] = is_equality(constraints.kind[r]) || wrong.local_element(r) != 0;
      }
    checks.error_energy = dual.jump_energy(wrong, held);

    double largest_contact = 0, largest_gap = 0, all_bounds = 0;
    for (const auto &point : constraints.contact_points)
      {
        const auto   node = contact_node(dual, point, multipliers, jumps, slip_bound, free);
        const double N = node.pressure * node.area, T = node.tangential_traction * node.area;
        const double bound = node.slip_bound * node.area;
        largest_contact    = std::max({largest_contact, std::abs(N), std::abs(T)});
        largest_gap        = std::max(largest_gap, std::abs(point.gap));
        checks.penetration = std::max(checks.penetration, -node.gap);
        checks.tension     = std::max(checks.tension, -N);
        if (point.normal_row != tfeti::invalid_row)
          checks.complementarity += std::abs(N * node.gap);
        if (point.tangential_row != tfeti::invalid_row)
          {
            all_bounds += bound;
            checks.friction_bound = std::max(checks.friction_bound, std::abs(T) - bound);
            checks.complementarity += std::abs(bound * std::abs(node.slip) + T * node.slip);
          }
        result.nodes.push_back(node);
        result.keys.push_back(point.key);
      }
    for (const auto &point : constraints.bonded_points)
      {
        result.nodes.push_back(bonded_node(point, multipliers, jumps));
        result.keys.push_back(point.key);
      }
    const auto on_bodies = balance(dual, forces, multipliers, n_bodies);

    for (double *maximum : {&checks.max_displacement,
                            &checks.interface_jump,
                            &checks.penetration,
                            &checks.tension,
                            &checks.friction_bound,
                            &largest_contact,
                            &largest_gap})
      *maximum = dealii::Utilities::MPI::max(*maximum, comm);
    for (double *sum : {&checks.energy, &checks.complementarity, &all_bounds})
      *sum = dealii::Utilities::MPI::sum(*sum, comm);
    // a scene that hardly moves is measured against its gaps, as the solver's residual |Pd| is
    const double no_length   = negligible_part_of_gap * largest_gap;
    const double no_force    = no_length / dual.norm();
    const double length      = std::max(checks.max_displacement, no_length);
    const double force       = std::max(largest_contact, no_force);
    const double energy      = std::max({checks.energy, no_force * no_length, all_bounds * no_length});
    checks.algebraic_error   = std::sqrt(relative(checks.error_energy, energy));
    checks.interface_jump    = relative(checks.interface_jump, length);
    checks.penetration       = relative(checks.penetration, length);
    checks.tension           = relative(checks.tension, force);
    checks.friction_bound    = relative(checks.friction_bound, force);
    checks.complementarity   = relative(checks.complementarity, energy);
    checks.nodal_equilibrium = relative(on_bodies.largest_left, std::max(on_bodies.largest, no_force));
    const unsigned int last  = on_bodies.left.rows() - 1; // the rotation
    for (unsigned int b = 0; b < n_bodies; ++b)
      {
        checks.force_balance =
          std::max(checks.force_balance,
                   relative(on_bodies.left.col(b).head(last).norm(), std::max(on_bodies.scale[b], no_force)));
        checks.moment_balance =
          std::max(checks.moment_balance,
                   relative(std::abs(on_bodies.left(last, b)), std::max(on_bodies.scale[b], no_force)));
      }
    return result;
  }

  std::vector<PairResult> pair_results(const std::vector<ContactNode> &nodes,
                                       const std::vector<std::string> &pair_names)
  {
    std::vector<PairResult> results(pair_names.size());
    for (unsigned int k = 0; k < pair_names.size(); ++k)
      results[k].pair = pair_names[k];
    for (const auto &node : nodes)
      {
        PairResult &result = results[node.pair];
        result.normal_force += node.pressure * node.area;
        result.tangential_force += node.tangential_traction * node.area;
        result.moment_mismatch += node.moment_mismatch;
        result.max_pressure = std::max(result.max_pressure, node.pressure);
        result.contact_length += node.is_closed ? node.length : 0.;
        result.contact_nodes += node.is_closed;
        result.open_nodes += !node.is_closed;
        result.slip_nodes += node.status == ContactStatus::slip;
        result.open_slip_nodes += node.status == ContactStatus::slip && !node.is_closed;
        result.stick_nodes += node.status == ContactStatus::stick;
      }
    return results;
  }
} // namespace slipstick::contact
