#include <slipstick/contact/checks.h>
#include <slipstick/contact/holding_forces.h>
#include <slipstick/contact/node_law.h>
#include <slipstick/qp/types.h>

#include <deal.II/base/mpi.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

namespace slipstick::contact
{
  namespace
  {
    using tfeti::DistributedVector;

    // Lengths below this fraction of the largest gap or displacement count as zero: the rounding level is about 1e-14
    // of these, and a tolerance of 1e-10 admits errors of 1e-7 of the smallest length that counts.
    constexpr double negligible_part = 1e-6;
    // Deformations below this fraction of these lengths count as zero: the stiffest ones are dominated by rounding.
    constexpr double negligible_deformation = 1e-5;
    // The steps of a load history are solved to a tolerance relative to its largest loads: displacements of a step
    // below this fraction of the largest one of the history count as zero.
    constexpr double part_of_history = 1e-2;
    // Lower limit of the reference force of a body, relative to the largest forces on any body.
    constexpr double negligible_load = 1e-3;
    // Rounding of K u, relative to the diagonal entry of the row times the largest displacement: the magnitudes of a
    // row add up to about six times that entry, and displacements are sums themselves.
    constexpr double rounding_of_forces = 128 * std::numeric_limits<double>::epsilon();
    // Slip bounds above this multiple of the largest contact force are cut off: the nodes stick in any case.
    constexpr double bounds_that_count = 2;

    /// Number of displacement components of a node.
    unsigned int n_components(const tfeti::SubdomainSystem &subdomain)
    {
      return tfeti::is_solid(subdomain.kernel().cols()) ? 3 : 2;
    }

    double relative(const double value, const double scale)
    {
      return scale > 0 ? value / scale : value;
    }

    /// Displacements minus the rigid motions of their subdomains, which no force resists: in products with K these
    /// would only contribute rounding errors.
    std::vector<Eigen::VectorXd> deformations(const tfeti::DualProblem &dual, const std::vector<Eigen::VectorXd> &u)
    {
      std::vector<Eigen::VectorXd> result = u;
      for (unsigned int p = 0; p < u.size(); ++p)
        {
          const Eigen::MatrixXd             &R = dual.subdomains()[p]->kernel();
          const Eigen::LDLT<Eigen::MatrixXd> gram(R.transpose() * R);
          for (unsigned int pass = 0; pass < 2; ++pass) // the second pass corrects the rounding of the first
            result[p] -= R * gram.solve(R.transpose() * result[p]);
        }
      return result;
    }

    /// Nodal forces K u - f of every subdomain, exerted by supports, contact and neighbouring subdomains.
    std::vector<Eigen::VectorXd> nodal_forces(const tfeti::DualProblem &dual, const std::vector<Eigen::VectorXd> &u)
    {
      std::vector<Eigen::VectorXd> forces;
      for (unsigned int p = 0; p < u.size(); ++p)
        forces.push_back(dual.subdomains()[p]->apply_stiffness(u[p]) - dual.subdomains()[p]->load());
      return forces;
    }

    /// Resultant forces and moments of K u - f + B'x on the bodies, and the force scales.
    struct Balance
    {
      Eigen::MatrixXd left;                // motions x bodies
      Eigen::VectorXd scale;               // by body: sum of the magnitudes of all external forces
      double          largest         = 0; // nodal: largest load, contact force or reaction
      double          beyond_rounding = 0; // nodal: residual in excess of the rounding of K u
    };

    /// @param on_node receives the residual force at a node of this rank.
    Balance balance(const tfeti::DualProblem           &dual,
                    const std::vector<Eigen::VectorXd> &u,
                    const std::vector<Eigen::VectorXd> &nodal_forces,
                    const DistributedVector            &multipliers,
                    const unsigned int                  n_bodies,
                    Largest                            &on_node)
    {
      const auto all = dual.dual_operator().forces(multipliers), holding = holding_forces(dual, multipliers);

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
          result.scale[system.body()] += system.load().cwiseAbs().sum() + holding[p].cwiseAbs().sum();
          result.largest =
            std::max({result.largest, system.load().cwiseAbs().maxCoeff(), holding[p].cwiseAbs().maxCoeff()});
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

    /// Reference values of the checks.
    struct Scales
    {
      double length, force, energy; // of this solution, at least the rounding level [mm], [N], [N mm]
      double no_force, no_strain;   // thresholds below which values count as zero [N], [mm]
      double no_energy;             // [N mm]
    };

    /// Checks of one solution. The order of the largest values is that of Checks::entries().
    class Inspection
    {
    public:
      Inspection(const tfeti::DualProblem           &dual_,
                 const SlipLaw                      &law_,
                 const DistributedVector            &multipliers_,
                 const std::vector<Eigen::VectorXd> &u_,
                 const std::vector<double>          &slip_bound_,
                 const std::vector<bool>            &free_,
                 const unsigned int                  n_bodies_,
                 const History                      &history_,
                 const std::vector<double>          &initial_strain_energies_)
        : dual(dual_)
        , law(law_)
        , constraints(dual_.constraints())
        , comm(dual_.communicator())
        , multipliers(multipliers_)
        , u(u_)
        , slip_bound(slip_bound_)
        , free(free_)
        , n_bodies(n_bodies_)
        , history(history_)
        , initial_strain_energies(initial_strain_energies_)
        , jumps(dual_.dual_operator().jumps(u_))
        , deformed(deformations(dual_, u_))
        , forces(nodal_forces(dual_, deformed))
      {}

      CheckedContact operator()()
      {
        measure_bodies();
        const auto error_energies = check_rows();
        collect_nodes();
        check_nodes();
        const auto   on_bodies = balance(dual, u, forces, multipliers, n_bodies, largest[nodal_equilibrium]);
        const Scales scales    = find_scales(on_bodies.largest);
        if (law.depends_on_pressure())
          check_open_nodes(scales);
        check_balance(on_bodies, scales);
        check_energies(error_energies, on_bodies, scales);
        for (unsigned int i = 0; i < Checks::n_entries; ++i)
          {
            largest[i].over_all_ranks(comm);
            result.checks.places[i] = largest[i].place;
          }
        make_relative(on_bodies, scales);
        divide_shared_nodes();
        return std::move(result);
      }

    private:
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

      /// Computes displacements and energies.
      void measure_bodies()
      {
        Checks         &checks   = result.checks;
        Eigen::VectorXd energies = Eigen::VectorXd::Zero(n_bodies);
        for (unsigned int p = 0; p < u.size(); ++p)
          {
            const unsigned int dim  = n_components(*dual.subdomains()[p]);
            checks.max_displacement = std::max(
              checks.max_displacement,
              Eigen::Map<const Eigen::MatrixXd>(u[p].data(), dim, u[p].size() / dim).colwise().norm().maxCoeff());
            energies[dual.subdomains()[p]->body()] += deformed[p].dot(forces[p] + dual.subdomains()[p]->load());
          }
        for (std::size_t b = 0; b < initial_strain_energies.size(); ++b)
          energies[b] += initial_strain_energies[b];
        checks.max_displacement = dealii::Utilities::MPI::max(checks.max_displacement, comm);
        MPI_Allreduce(MPI_IN_PLACE, energies.data(), energies.size(), MPI_DOUBLE, MPI_SUM, comm);
        checks.energy = energies.sum();
        checks.energies.assign(energies.data(), energies.data() + energies.size());
      }

      /// Violation of an equality or closed row [mm].
      double violation(const unsigned int r) const
      {
        const double compliance = constraints.compliance.empty() ? 0. : constraints.compliance[r];
        return jumps.local_element(r) - constraints.c[r] - compliance * multipliers.local_element(r);
      }

      /// Checks inadmissible jumps. @return the energies of the displacements that would close them.
      tfeti::JumpEnergies check_rows()
      {
        unsigned int row_of_jump = tfeti::invalid_row;
        for (unsigned int r = 0; r < constraints.kind.size(); ++r)
          if (is_equality(constraints.kind[r]) && largest[jump].take(std::abs(violation(r)), Place()))
            row_of_jump = r;
        const double      noise = qp::force_rounding * multipliers.linfty_norm();
        DistributedVector wrong = jumps;
        std::vector<bool> held(constraints.kind.size());
        for (unsigned int r = 0; r < held.size(); ++r)
          {
            wrong.local_element(r) = free[r] ? violation(r)
                                             : inadmissible_jump(constraints.kind[r],
                                                                 violation(r),
                                                                 multipliers.local_element(r),
                                                                 slip_bound[r],
                                                                 noise);
            // slip in a wrong direction is the error of a force of at most twice the bound; the rest moves a body as a
            // whole, without energy
            if (const double most = 2 * slip_bound[r] * dual.norm();
                constraints.kind[r] == tfeti::RowKind::tangential && !free[r])
              wrong.local_element(r) = std::min(std::max(wrong.local_element(r), -most), most);
            held[r] = is_equality(constraints.kind[r]) || wrong.local_element(r) != 0;
          }
        find_place_of_row(dual, row_of_jump, largest[jump]);
        auto energies              = tfeti::jump_energies(dual, wrong, held);
        result.checks.error_energy = energies.of_body.sum();
        add_errors_of_bounds(energies.forces);
        const TractionErrors tractions(dual, multipliers, energies.forces);
        result.checks.largest_traction = tractions.largest_norm();
        result.checks.traction_errors  = tractions.relative(part_of_history * history.traction);
        return energies;
      }

      /// Adds the errors of the bounds of slipping nodes, which follow from the errors of their normal forces.
      void add_errors_of_bounds(DistributedVector &errors) const
      {
        for (const qp::PressureBound &bound : law.pressure_bounds())
          {
            const double along  = multipliers.local_element(bound.tangential);
            const double across = bound.is_disc() ? multipliers.local_element(bound.second) : 0.;
            const double size   = std::hypot(along, across);
            if (free[bound.tangential] || size == 0 || bound.normal == qp::no_entry)
              continue;
            const double change = bound.forces.slope(size) * errors.local_element(bound.normal);
            errors.local_element(bound.tangential) += along / size * change;
            if (bound.is_disc())
              errors.local_element(bound.second) += across / size * change;
          }
      }

      void collect_nodes()
      {
        const double noise = qp::force_rounding * multipliers.linfty_norm();
        for (const auto &point : constraints.contact_points)
          {
            const auto node = contact_node(dual, point, multipliers, jumps, slip_bound, free, noise);
            largest_contact = std::max(
              {largest_contact, std::abs(node.pressure * node.area), std::abs(node.tangential_traction * node.area)});
            largest_gap = std::max(largest_gap, std::abs(point.gap));
            result.nodes.push_back(node);
            result.keys.push_back(point.key);
          }
        for (const auto &point : constraints.bonded_points)
          {
            result.nodes.push_back(bonded_node(dual, point, multipliers, jumps));
            result.keys.push_back(point.key);
          }
        for (double *maximum : {&largest_contact, &largest_gap})
          *maximum = dealii::Utilities::MPI::max(*maximum, comm);
        result.checks.largest_force = largest_contact;
      }

      /// What the law of a contact that a bond implies does not admit, the bond bears alone.
      static void limit_to_law(const qp::NodeSet &forces, ContactNode &contact, ContactNode &bond)
      {
        const auto give = [&](double &of_contact, double &of_bond, const double part) {
          of_bond += part * of_contact * contact.area / bond.area;
          of_contact -= part * of_contact;
        };
        contact.is_closed  = contact.pressure >= 0;
        contact.status     = contact.is_closed ? ContactStatus::stick : ContactStatus::open;
        const double bound = contact.is_closed ? forces.radius(contact.pressure * contact.area) : 0.;
        const double along = std::abs(contact.tangential_traction) * contact.area;
        contact.slip_bound = bound / contact.area;
        if (!contact.is_closed)
          give(contact.pressure, bond.pressure, 1.);
        if (along > bound)
          {
            const double part = 1 - bound / along;
            give(contact.tangential_traction, bond.tangential_traction, part);
            for (unsigned int d = 0; d < contact.traction.size(); ++d)
              give(contact.traction[d], bond.traction[d], part);
          }
      }

      /// Nodes so far have the forces of all pairs that meet there: divides them, nodes of other pairs are added behind.
      void divide_shared_nodes()
      {
        if (constraints.shared_points.empty())
          return;
        auto      &nodes = result.nodes;
        const auto whole = nodes;
        const auto n     = constraints.contact_points.size();
        for (unsigned int i = 0; i < nodes.size(); ++i)
          nodes[i] = part_of(whole[i], i < n ? constraints.contact_points[i] : constraints.bonded_points[i - n]);
        for (const auto &shared : constraints.shared_points)
          {
            const std::size_t carrier = shared.carrier + (shared.is_bonded ? n : 0);
            auto              part    = part_of(whole[carrier], shared.point);
            if (shared.law)
              limit_to_law(*shared.law, part, nodes[carrier]);
            nodes.push_back(part);
            result.keys.push_back(shared.point.key);
          }
      }

      /// Checks the contact law at the nodes, except bonded ones.
      void check_nodes()
      {
        const double noise = qp::force_rounding * multipliers.linfty_norm();
        for (unsigned int i = 0; i < constraints.contact_points.size(); ++i)
          {
            const auto  &point = constraints.contact_points[i];
            const auto  &node  = result.nodes[i];
            const Place  place = {true, point.slave_body, point.position, true, true, point.pair};
            const double N = node.pressure * node.area, T = node.tangential_traction * node.area;
            largest[penetration].take(-node.gap, place);
            largest[tension].take(-N > noise ? -N : 0., place);
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
                work += missing_friction_work(capped, friction_work(point, node), node.slip);
              }
            result.checks.complementarity += work;
            largest[complementarity].take(work, place);
          }
        for (double *sum : {&result.checks.complementarity, &all_bounds})
          *sum = dealii::Utilities::MPI::sum(*sum, comm);
      }

      /// Open nodes whose bound follows the pressure carry no force: relative to the largest tangential force of their
      /// pair, however small that is beside the normal forces.
      void check_open_nodes(const Scales &scales)
      {
        unsigned int n_pairs = 0;
        for (const auto &point : constraints.contact_points)
          n_pairs = std::max(n_pairs, point.pair + 1);
        n_pairs = dealii::Utilities::MPI::max(n_pairs, comm);
        std::vector<double> of_pair(n_pairs, std::max(negligible_part * largest_contact, scales.no_force));
        const auto          force_at = [&](const unsigned int i) {
          return std::abs(result.nodes[i].tangential_traction * result.nodes[i].area);
        };
        for (unsigned int i = 0; i < constraints.contact_points.size(); ++i)
          of_pair[result.nodes[i].pair] = std::max(of_pair[result.nodes[i].pair], force_at(i));
        MPI_Allreduce(MPI_IN_PLACE, of_pair.data(), of_pair.size(), MPI_DOUBLE, MPI_MAX, comm);
        const double      noise = qp::force_rounding * multipliers.linfty_norm();
        std::vector<bool> follows(constraints.kind.size(), false);
        for (const auto &bound : law.pressure_bounds())
          follows[bound.tangential] = true;
        for (unsigned int i = 0; i < constraints.contact_points.size(); ++i)
          {
            const auto &point = constraints.contact_points[i];
            if (point.tangential_row != tfeti::invalid_row && follows[point.tangential_row] &&
                !result.nodes[i].is_closed && force_at(i) > noise)
              largest[friction_bound].take(scales.force * relative(force_at(i), of_pair[point.pair]),
                                           {true, point.slave_body, point.position, true, true, point.pair});
          }
      }

      static double friction_work(const tfeti::ContactPoint &point, const ContactNode &node)
      {
        if (!point.is_in_space())
          return node.tangential_traction * node.area * node.slip;
        return node.area * (node.traction[0] * node.slip_vector[0] + node.traction[1] * node.slip_vector[1] +
                            node.traction[2] * node.slip_vector[2]);
      }

      /// @param largest_force nodal: largest load, contact force or reaction.
      Scales find_scales(const double largest_force) const
      {
        const double way    = std::max(largest_gap, result.checks.max_displacement);
        const double before = part_of_history * history.displacement;
        // supports may carry all loads right where these act: then only rounding remains
        const double rounding  = qp::force_rounding * largest_force;
        const double no_length = std::max(negligible_part * way, before);
        Scales       scales;
        scales.no_strain = std::max(negligible_deformation * way, before);
        scales.no_force  = std::max(scales.no_strain / dual.norm(), part_of_history * history.force);
        scales.length    = std::max({result.checks.max_displacement, no_length, rounding * dual.norm()});
        scales.force     = std::max(largest_contact, scales.no_force);
        const double energy_before =
          part_of_history * part_of_history * std::accumulate(history.energies.begin(), history.energies.end(), 0.);
        scales.no_energy = std::max(scales.no_force * scales.no_strain, rounding * rounding * dual.norm());
        scales.energy =
          std::max({result.checks.energy, scales.no_energy, all_bounds * scales.no_strain, energy_before});
        return scales;
      }

      void check_balance(const Balance &on_bodies, const Scales &scales)
      {
        for (unsigned int b = 0; b < n_bodies; ++b)
          {
            const unsigned int k = on_bodies.left.rows(), n_forces = tfeti::n_translations(k); // forces, then moments
            const double       scale = std::max(on_bodies.scale[b], scales.no_force);
            largest[force_balance].take(relative(on_bodies.left.col(b).head(n_forces).norm(), scale), {true, b});
            if (k > n_forces)
              largest[moment_balance].take(relative(on_bodies.left.col(b).tail(k - n_forces).norm(), scale), {true, b});
          }
      }

      /// Checks the energy of every body; also of stiff bodies among soft ones, whose share of the total energy is
      /// small.
      void check_energies(const tfeti::JumpEnergies &error_energies, const Balance &on_bodies, const Scales &scales)
      {
        const double least_load = negligible_load * on_bodies.scale.maxCoeff();
        unsigned int worst_body = 0;
        for (unsigned int b = 0; b < n_bodies; ++b)
          {
            const double share = least_load > 0 ? std::min(1., on_bodies.scale[b] / least_load) : 1.;
            const double error = error_energies.of_body[b];
            const double least =
              std::max(scales.no_energy,
                       history.energies.empty() ? 0. : part_of_history * part_of_history * history.energies[b]);
            const double energy = std::max(result.checks.energies[b], least);
            if (largest[energy_norm].take(share * std::sqrt(relative(error, energy)), Place()))
              worst_body = b;
          }
        find_place_in_body(dual, error_energies, worst_body, largest[energy_norm]);
      }

      void make_relative(const Balance &on_bodies, const Scales &scales)
      {
        Checks &checks         = result.checks;
        checks.algebraic_error = std::sqrt(relative(checks.error_energy, scales.energy));
        checks.body_error      = std::max(largest[energy_norm].value, checks.algebraic_error);
        checks.interface_jump  = relative(largest[jump].value, scales.length);
        checks.penetration     = relative(largest[penetration].value, scales.length);
        checks.tension         = relative(largest[tension].value, scales.force);
        checks.friction_bound  = relative(largest[friction_bound].value, scales.force);
        checks.complementarity = relative(checks.complementarity, scales.energy);
        // if there are no forces, the displacement of stiff bodies is only rounding
        const double at_nodes    = largest[nodal_equilibrium].value;
        checks.nodal_equilibrium = on_bodies.largest < scales.no_force && !std::isnan(at_nodes)
                                     ? relative(on_bodies.beyond_rounding, scales.no_force)
                                     : relative(at_nodes, std::max(on_bodies.largest, scales.no_force));
        checks.force_balance     = largest[force_balance].value;
        checks.moment_balance    = largest[moment_balance].value;
      }

      const tfeti::DualProblem           &dual;
      const SlipLaw                      &law;
      const tfeti::Constraints           &constraints;
      const MPI_Comm                      comm;
      const DistributedVector            &multipliers;
      const std::vector<Eigen::VectorXd> &u;
      const std::vector<double>          &slip_bound;
      const std::vector<bool>            &free;
      const unsigned int                  n_bodies;
      const History                      &history;
      const std::vector<double>          &initial_strain_energies; // of this rank's bodies [N mm]; empty: none

      const DistributedVector                jumps;
      const std::vector<Eigen::VectorXd>     deformed; // u without rigid motions
      const std::vector<Eigen::VectorXd>     forces;   // K u - f
      std::array<Largest, Checks::n_entries> largest;
      double                                 largest_contact = 0, largest_gap = 0, all_bounds = 0;
      CheckedContact                         result;
    };
  } // namespace

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

  double Checks::largest_traction_error() const
  {
    double result = 0;
    for (const PairTractions &pair : traction_errors)
      result = std::max({result, pair.pressure, pair.tangential});
    return result;
  }

  void History::add(const Checks &step)
  {
    displacement = std::max(displacement, step.max_displacement);
    force        = std::max(force, step.largest_force);
    traction     = std::max(traction, step.largest_traction);
    energies.resize(step.energies.size());
    for (std::size_t b = 0; b < energies.size(); ++b)
      energies[b] = std::max(energies[b], step.energies[b]);
  }

  CheckedContact check(const tfeti::DualProblem           &dual,
                       const SlipLaw                      &law,
                       const DistributedVector            &multipliers,
                       const std::vector<Eigen::VectorXd> &u,
                       const std::vector<double>          &slip_bound,
                       const std::vector<bool>            &free,
                       const unsigned int                  n_bodies,
                       const History                      &history,
                       const std::vector<double>          &initial_strain_energies)
  {
    return Inspection(dual, law, multipliers, u, slip_bound, free, n_bodies, history, initial_strain_energies)();
  }
} // namespace slipstick::contact
