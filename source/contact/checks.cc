#include <slipstick/contact/checks.h>
#include <slipstick/contact/node_law.h>

#include <deal.II/base/mpi.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <optional>

namespace slipstick::contact
{
  namespace
  {
    using tfeti::DistributedVector;

    // Lengths below this fraction of the largest gap or displacement count as zero: rounding leaves some 1e-14 of
    // these, a tolerance of 1e-10 allows 1e-7 of what remains here.
    constexpr double negligible_part = 1e-6;
    // Deformations below this fraction of these count as zero: rounding shows in the stiffest of them.
    constexpr double negligible_deformation = 1e-5;
    // The steps of a history are solved to a tolerance relative to its largest loads: displacements of a step below
    // this fraction of the largest one of the history count as zero.
    constexpr double part_of_history = 1e-2;
    // Lower limit on the forces that count for a body, relative to the largest forces on any body.
    constexpr double negligible_load = 1e-3;
    // Rounding of K u, over the diagonal entry of its row times the largest displacement: the magnitudes of a row add up to some
    // six times that entry, and displacements are sums themselves.
    constexpr double rounding_of_forces = 128 * std::numeric_limits<double>::epsilon();
    // Slip bounds above this multiple of the largest contact force only mean that nodes stick.
    constexpr double bounds_that_count = 2;

    /// The largest of some numbers (0 if there are none; a NaN persists) and where it is.
    struct Largest
    {
      double value = 0;
      Place  place;

      /// @return whether @p other is the largest so far.
      bool take(const double other, const Place &where)
      {
        if (std::isnan(value) || !(std::isnan(other) || other > value))
          return false;
        value = other;
        place = where;
        return true;
      }

      /// The first of the ranks with the largest value broadcasts it. Collective.
      void over_all_ranks(const MPI_Comm comm)
      {
        const std::vector<double> own{value,
                                      static_cast<double>(place.is_known),
                                      static_cast<double>(place.body),
                                      place.position[0],
                                      place.position[1],
                                      place.position[2],
                                      static_cast<double>(place.is_point),
                                      static_cast<double>(place.in_pair),
                                      static_cast<double>(place.pair)};
        Largest                   all;
        for (const auto &n : dealii::Utilities::MPI::all_gather(comm, own))
          {
            const Place where = {n[1] > 0,
                                 static_cast<unsigned int>(n[2]),
                                 {{n[3], n[4], n[5]}},
                                 n[6] > 0,
                                 n[7] > 0,
                                 static_cast<unsigned int>(n[8])};
            if (!all.take(n[0], where) && n[0] == all.value && !all.place.is_known)
              all.place = where; // a rank that knows the value, not the place, came first
          }
        *this = all;
      }
    };

    /// The pair of contact of a row where x (owned rows) is not 0, the same on all ranks; none: nothing. Collective.
    std::optional<unsigned int> pair_of(const tfeti::DualProblem &dual, const DistributedVector &x)
    {
      unsigned int pair = 0; // its number + 1, 0 for none
      for (const auto &point : dual.constraints().contact_points)
        for (const unsigned int row : {point.normal_row, point.tangential_row, point.second_row})
          if (row != tfeti::invalid_row && x.local_element(row) != 0)
            pair = point.pair + 1;
      pair = dealii::Utilities::MPI::max(pair, dual.communicator());
      return pair > 0 ? std::make_optional(pair - 1) : std::nullopt;
    }

    Place place_of(const tfeti::SubdomainSystem     &subdomain,
                   const unsigned int                unknown,
                   const std::optional<unsigned int> pair)
    {
      return {true, subdomain.body(), subdomain.position(unknown), true, pair.has_value(), pair.value_or(0)};
    }

    /// Is this the first rank on which it is true? Collective.
    bool is_first(const bool says_so, const MPI_Comm comm)
    {
      const unsigned int rank = dealii::Utilities::MPI::this_mpi_process(comm);
      return rank == dealii::Utilities::MPI::min(says_so ? rank : dealii::Utilities::MPI::n_mpi_processes(comm), comm);
    }

    /// Maximum over all ranks of the violations of owned rows, with a node that the row touches, on the rank of its
    /// subdomain. Collective.
    void find_place_of_row(const tfeti::DualProblem &dual, const unsigned int owned_row, Largest &violation)
    {
      const MPI_Comm    comm    = dual.communicator();
      const double      largest = dealii::Utilities::MPI::max(violation.value, comm);
      DistributedVector one     = dual.zero();
      if (is_first(owned_row != tfeti::invalid_row && violation.value == largest, comm))
        one.local_element(owned_row) = 1;
      const auto pair    = pair_of(dual, one);
      const auto touched = dual.forces(one);
      for (unsigned int p = 0; p < touched.size(); ++p)
        {
          Eigen::Index unknown;
          if (touched[p].size() > 0 && touched[p].cwiseAbs().maxCoeff(&unknown) > 0)
            violation.place = place_of(*dual.subdomains()[p], unknown, pair);
        }
      if (!std::isnan(violation.value))
        violation.value = largest;
    }

    /// Where a body has most of the energy of its jumps, and the pair that touches there. Collective.
    void find_place_in_body(const tfeti::DualProblem               &dual,
                            const tfeti::DualProblem::JumpEnergies &energies,
                            const unsigned int                      body,
                            Largest                                &error)
    {
      const MPI_Comm comm  = dual.communicator();
      const auto    &spot  = energies.spots[body];
      const double   most  = dealii::Utilities::MPI::max(spot.energy, comm);
      const bool     is_it = is_first(spot.energy >= 0 && spot.energy == most, comm);
      const auto     pair = pair_of(dual, dual.column(is_it ? spot.subdomain : dual.subdomains().size(), spot.touched));
      if (is_it)
        {
          const auto &subdomain = *dual.subdomains()[spot.subdomain];
          error.place           = place_of(subdomain, subdomain.touched()[spot.touched], pair);
        }
    }

    /// Of the displacement of a node.
    unsigned int n_components(const tfeti::SubdomainSystem &subdomain)
    {
      return tfeti::is_solid(subdomain.kernel().cols()) ? 3 : 2;
    }

    double relative(const double value, const double scale)
    {
      return scale > 0 ? value / scale : value;
    }

    /// Displacements without the rigid motions of their subdomains, which no force resists: in products with K these
    /// would contribute nothing but rounding.
    std::vector<Eigen::VectorXd> deformations(const tfeti::DualProblem &dual, const std::vector<Eigen::VectorXd> &u)
    {
      std::vector<Eigen::VectorXd> result = u;
      for (unsigned int p = 0; p < u.size(); ++p)
        {
          const Eigen::MatrixXd             &R = dual.subdomains()[p]->kernel();
          const Eigen::LDLT<Eigen::MatrixXd> gram(R.transpose() * R);
          for (unsigned int pass = 0; pass < 2; ++pass) // the second one for the rounding of the first
            result[p] -= R * gram.solve(R.transpose() * result[p]);
        }
      return result;
    }

    /// Nodal forces K u - f of every subdomain, exerted by supports, contact and neighbours.
    std::vector<Eigen::VectorXd> nodal_forces(const tfeti::DualProblem &dual, const std::vector<Eigen::VectorXd> &u)
    {
      std::vector<Eigen::VectorXd> forces;
      for (unsigned int p = 0; p < u.size(); ++p)
        forces.push_back(dual.subdomains()[p]->apply_stiffness(u[p]) - dual.subdomains()[p]->load());
      return forces;
    }

    /// Forces and moments left on the bodies by K u - f + B'x, and the force scales.
    struct Balance
    {
      Eigen::MatrixXd left;                // motions x bodies
      Eigen::VectorXd scale;               // by body: sum of the magnitudes of all outside forces
      double          largest         = 0; // nodal: largest load, contact force or reaction
      double          beyond_rounding = 0; // nodal: what is left beyond the rounding of K u
    };

    /// @param on_node gets the residual force at a node of this rank.
    Balance balance(const tfeti::DualProblem           &dual,
                    const std::vector<Eigen::VectorXd> &u,
                    const std::vector<Eigen::VectorXd> &nodal_forces,
                    const DistributedVector            &multipliers,
                    const unsigned int                  n_bodies,
                    Largest                            &on_node)
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
          const Eigen::VectorXd rounding =
            rounding_of_forces * u[p].cwiseAbs().maxCoeff() * system.stiffness_diagonal();
          Eigen::Index unknown = 0;
          for (Eigen::Index i = 0; i < left.size(); ++i)
            {
              if (on_node.take(std::abs(left[i]), Place()))
                unknown = i + 1;
              result.beyond_rounding = std::max(result.beyond_rounding, std::abs(left[i]) - rounding[i]);
            }
          if (unknown > 0)
            on_node.place = {true, system.body(), system.position(unknown - 1), true};
        }
      MPI_Allreduce(MPI_IN_PLACE, result.left.data(), result.left.size(), MPI_DOUBLE, MPI_SUM, dual.communicator());
      MPI_Allreduce(MPI_IN_PLACE, result.scale.data(), result.scale.size(), MPI_DOUBLE, MPI_SUM, dual.communicator());
      result.largest         = dealii::Utilities::MPI::max(result.largest, dual.communicator());
      result.beyond_rounding = dealii::Utilities::MPI::max(result.beyond_rounding, dual.communicator());
      return result;
    }

    /// Has it tangents of its own?
    bool is_in_space(const tfeti::ContactPoint &point)
    {
      const auto &t = point.tangents[0];
      return t[0] != 0 || t[1] != 0 || t[2] != 0;
    }

    /// Moment of the forces on both sides: force on the slave body at its node, the opposite one at the mean of the
    /// master nodes.
    /// @param N compressive force, @param T minus the tangential force on the slave body, in the plane.
    std::array<double, 3> moment_mismatch(const tfeti::ContactPoint &point,
                                          const ContactNode         &node,
                                          const double               N,
                                          const double               T)
    {
      if (!point.has_master)
        return {{0, 0, 0}};
      std::array<double, 3> force{
        {-(N * point.normal[0] - T * point.normal[1]), -(N * point.normal[1] + T * point.normal[0]), 0}};
      if (is_in_space(point))
        for (unsigned int d = 0; d < 3; ++d)
          force[d] = node.traction[d] * node.area - N * point.normal[d];
      std::array<double, 3> apart;
      for (unsigned int d = 0; d < 3; ++d)
        apart[d] = point.position[d] - point.master_position[d];
      Resultant mismatch;
      mismatch.add<3>(force, apart);
      return mismatch.moment;
    }

    /// Vectors and lengths of tangential traction and slip.
    void complete_in_space(const tfeti::DualProblem  &dual,
                           const tfeti::ContactPoint &point,
                           const DistributedVector   &multipliers,
                           const DistributedVector   &jumps,
                           ContactNode               &node)
    {
      for (const unsigned int k : {0, 1})
        {
          const unsigned int row = k == 0 ? point.tangential_row : point.second_row;
          if (row == tfeti::invalid_row) // a support holds the node there
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
      node.status       = status_of(node.is_closed, 0., false);
      double tangential = 0;
      if (point.tangential_row != tfeti::invalid_row)
        {
          tangential               = multipliers.local_element(point.tangential_row);
          node.tangential_traction = -tangential / node.area; // on the slave body
          node.slip       = jumps.local_element(point.tangential_row) - dual.constraints().c[point.tangential_row];
          node.slip_bound = slip_bound[point.tangential_row] / node.area;
          node.status     = status_of(node.is_closed, node.slip_bound, free[point.tangential_row]);
        }
      if (is_in_space(point))
        complete_in_space(dual, point, multipliers, jumps, node);
      node.moment_mismatch = moment_mismatch(point, node, node.pressure * node.area, tangential);
      return node;
    }

    /// One node of a bonded pair: it sticks whatever the tractions; a row that others imply carries none.
    ContactNode bonded_node(const tfeti::DualProblem  &dual,
                            const tfeti::ContactPoint &point,
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
      if (is_in_space(point))
        complete_in_space(dual, point, multipliers, jumps, node);
      node.moment_mismatch = moment_mismatch(point, node, node.pressure * node.area, tangential);
      return node;
    }
  } // namespace

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

  std::array<Checks::Entry, Checks::n_entries> Checks::entries() const
  {
    return {{{"interface jump", interface_jump, false, places[0]},
             {"penetration", penetration, false, places[1]},
             {"complementarity", complementarity, false, places[2]},
             {"tension in contact", tension, false, places[3]},
             {"friction bound", friction_bound, false, places[4]},
             {"equilibrium of a node", nodal_equilibrium, true, places[5]},
             {"force balance", force_balance, true, places[6]},
             {"moment balance", moment_balance, true, places[7]},
             {"error in the energy norm", body_error, false, places[8]}}};
  }

  Checks::Entry Checks::worst_entry() const
  {
    const auto all = entries();
    return *std::max_element(all.begin(), all.end(), [](const Entry &a, const Entry &b) {
      return !std::isnan(a.value) && (std::isnan(b.value) || a.value < b.value);
    });
  }

  std::pair<std::string, double> Checks::worst() const
  {
    const Entry entry = worst_entry();
    return {entry.name, entry.value};
  }

  void History::add(const Checks &step)
  {
    displacement = std::max(displacement, step.max_displacement);
    force        = std::max(force, step.largest_force);
    energies.resize(step.energies.size());
    for (std::size_t b = 0; b < energies.size(); ++b)
      energies[b] = std::max(energies[b], step.energies[b]);
  }

  CheckedContact check(const tfeti::DualProblem           &dual,
                       const DistributedVector            &multipliers,
                       const std::vector<Eigen::VectorXd> &u,
                       const std::vector<double>          &slip_bound,
                       const std::vector<bool>            &free,
                       const unsigned int                  n_bodies,
                       const History                      &history,
                       const std::vector<double>          &energies_beside)
  {
    const MPI_Comm comm        = dual.communicator();
    const auto    &constraints = dual.constraints();
    const auto     jumps       = dual.jumps(u);
    const auto     deformed    = deformations(dual, u);
    const auto     forces      = nodal_forces(dual, deformed);
    CheckedContact result;
    Checks        &checks = result.checks;
    enum
    {
      jump,
      penetration,
      complementarity,
      tension,
      friction_bound,
      nodal_equilibrium,
      force_balance,
      moment_balance,
      energy_norm
    };
    std::array<Largest, Checks::n_entries> largest;

    Eigen::VectorXd energies = Eigen::VectorXd::Zero(n_bodies);
    for (unsigned int p = 0; p < u.size(); ++p)
      {
        const unsigned int dim = n_components(*dual.subdomains()[p]);
        checks.max_displacement =
          std::max(checks.max_displacement,
                   Eigen::Map<const Eigen::MatrixXd>(u[p].data(), dim, u[p].size() / dim).colwise().norm().maxCoeff());
        energies[dual.subdomains()[p]->body()] += deformed[p].dot(forces[p] + dual.subdomains()[p]->load());
      }
    for (std::size_t b = 0; b < energies_beside.size(); ++b)
      energies[b] += energies_beside[b];
    const auto violation = [&](const unsigned int r) {
      const double compliance = constraints.compliance.empty() ? 0. : constraints.compliance[r];
      return jumps.local_element(r) - constraints.c[r] - compliance * multipliers.local_element(r);
    };
    unsigned int row_of_jump = tfeti::invalid_row;
    for (unsigned int r = 0; r < constraints.kind.size(); ++r)
      if (is_equality(constraints.kind[r]) && largest[jump].take(std::abs(violation(r)), Place()))
        row_of_jump = r;
    const double      noise = tfeti::force_rounding * multipliers.linfty_norm();
    DistributedVector wrong = jumps;
    std::vector<bool> held(constraints.kind.size());
    for (unsigned int r = 0; r < held.size(); ++r)
      {
        wrong.local_element(r) =
          free[r]
            ? violation(r)
            : inadmissible_jump(constraints.kind[r], violation(r), multipliers.local_element(r), slip_bound[r], noise);
        held[r] = is_equality(constraints.kind[r]) || wrong.local_element(r) != 0;
      }
    const auto error_energies = dual.jump_energies(wrong, held);
    checks.error_energy       = error_energies.of_body.sum();

    double largest_contact = 0, largest_gap = 0;
    for (const auto &point : constraints.contact_points)
      {
        const auto node = contact_node(dual, point, multipliers, jumps, slip_bound, free);
        largest_contact = std::max(
          {largest_contact, std::abs(node.pressure * node.area), std::abs(node.tangential_traction * node.area)});
        largest_gap = std::max(largest_gap, std::abs(point.gap));
        result.nodes.push_back(node);
        result.keys.push_back(point.key);
      }
    for (double *maximum : {&checks.max_displacement, &largest_contact, &largest_gap})
      *maximum = dealii::Utilities::MPI::max(*maximum, comm);

    double all_bounds = 0;
    for (unsigned int i = 0; i < constraints.contact_points.size(); ++i)
      {
        const auto  &point = constraints.contact_points[i];
        const auto  &node  = result.nodes[i];
        const Place  place = {true, point.slave_body, point.position, true, true, point.pair};
        const double N = node.pressure * node.area, T = node.tangential_traction * node.area;
        largest[penetration].take(-node.gap, place);
        largest[tension].take(-N, place);
        double work = 0;
        if (point.normal_row != tfeti::invalid_row)
          work += std::abs(N * node.gap);
        if (point.tangential_row != tfeti::invalid_row)
          {
            const double bound = node.slip_bound * node.area;
            largest[friction_bound].take(std::abs(T) - bound, place);
            // a bound far above all forces would turn rounding at sticking nodes into work
            const double capped = std::max(std::abs(T), std::min(bound, bounds_that_count * largest_contact));
            all_bounds += capped;
            const double friction_work = !is_in_space(point) ? T * node.slip
                                                             : node.area * (node.traction[0] * node.slip_vector[0] +
                                                                            node.traction[1] * node.slip_vector[1] +
                                                                            node.traction[2] * node.slip_vector[2]);
            work += missing_friction_work(capped, friction_work, node.slip);
          }
        checks.complementarity += work;
        largest[complementarity].take(work, place);
      }
    for (const auto &point : constraints.bonded_points)
      {
        result.nodes.push_back(bonded_node(dual, point, multipliers, jumps));
        result.keys.push_back(point.key);
      }
    MPI_Allreduce(MPI_IN_PLACE, energies.data(), energies.size(), MPI_DOUBLE, MPI_SUM, comm);
    checks.energy = energies.sum();
    checks.energies.assign(energies.data(), energies.data() + energies.size());
    checks.largest_force = largest_contact;
    for (double *sum : {&checks.complementarity, &all_bounds})
      *sum = dealii::Utilities::MPI::sum(*sum, comm);
    const double way       = std::max(largest_gap, checks.max_displacement);
    const double before    = part_of_history * history.displacement;
    const double no_length = std::max(negligible_part * way, before);
    const double no_strain = std::max(negligible_deformation * way, before);
    const double no_force  = std::max(no_strain / dual.norm(), part_of_history * history.force);
    const double length    = std::max(checks.max_displacement, no_length);
    const double force     = std::max(largest_contact, no_force);
    const double energy_before =
      part_of_history * part_of_history * std::accumulate(history.energies.begin(), history.energies.end(), 0.);
    const double energy    = std::max({checks.energy, no_force * no_strain, all_bounds * no_strain, energy_before});
    const auto   on_bodies = balance(dual, u, forces, multipliers, n_bodies, largest[nodal_equilibrium]);
    for (unsigned int b = 0; b < n_bodies; ++b)
      {
        const unsigned int k = on_bodies.left.rows(), n_forces = tfeti::n_translations(k); // the moments come last
        const double       scale = std::max(on_bodies.scale[b], no_force);
        largest[force_balance].take(relative(on_bodies.left.col(b).head(n_forces).norm(), scale), {true, b});
        if (k > n_forces)
          largest[moment_balance].take(relative(on_bodies.left.col(b).tail(k - n_forces).norm(), scale), {true, b});
      }
    checks.algebraic_error = std::sqrt(relative(checks.error_energy, energy));
    // also of stiff bodies among soft ones, which have little of the energy
    const double least_load = negligible_load * on_bodies.scale.maxCoeff();
    unsigned int worst_body = 0;
    for (unsigned int b = 0; b < n_bodies; ++b)
      {
        const double share = least_load > 0 ? std::min(1., on_bodies.scale[b] / least_load) : 1.;
        const double error = std::max(error_energies.of_body[b], 0.);
        const double least =
          std::max(no_force * no_strain,
                   history.energies.empty() ? 0. : part_of_history * part_of_history * history.energies[b]);
        if (largest[energy_norm].take(share * std::sqrt(relative(error, std::max(energies[b], least))), Place()))
          worst_body = b;
      }
    find_place_in_body(dual, error_energies, worst_body, largest[energy_norm]);
    find_place_of_row(dual, row_of_jump, largest[jump]);
    for (unsigned int i = 0; i < Checks::n_entries; ++i)
      {
        largest[i].over_all_ranks(comm);
        checks.places[i] = largest[i].place;
      }
    checks.body_error      = std::max(largest[energy_norm].value, checks.algebraic_error);
    checks.interface_jump  = relative(largest[jump].value, length);
    checks.penetration     = relative(largest[penetration].value, length);
    checks.tension         = relative(largest[tension].value, force);
    checks.friction_bound  = relative(largest[friction_bound].value, force);
    checks.complementarity = relative(checks.complementarity, energy);
    // where nothing bears anything, the displacement of stiff bodies leaves rounding alone
    checks.nodal_equilibrium = on_bodies.largest < no_force && !std::isnan(largest[nodal_equilibrium].value)
                                 ? relative(on_bodies.beyond_rounding, no_force)
                                 : relative(largest[nodal_equilibrium].value, std::max(on_bodies.largest, no_force));
    checks.force_balance     = largest[force_balance].value;
    checks.moment_balance    = largest[moment_balance].value;
    return result;
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
        result.on_slave.add<3>(force, node.position);
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
