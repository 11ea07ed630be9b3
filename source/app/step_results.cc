#include <slipstick/app/step_results.h>
#include <slipstick/contact/resultants.h>
#include <slipstick/interface/arc_length.h>
#include <slipstick/mechanics/elasticity.h>
#include <slipstick/mechanics/loads.h>
#include <slipstick/mechanics/singular_points.h>

#include <deal.II/base/mpi.h>

#include <boost/serialization/array.hpp>
#include <boost/serialization/vector.hpp>

#include <cmath>

namespace slipstick::app
{
  namespace
  {
    constexpr int dim = 2;

    // A singular point raises the stress as far as so many diameters of the cells around the node with the largest one:
    // stresses at nodes are means over cells, and may be largest beside it.
    constexpr double cells_of_singularity = 1.5;

    // Forces on what holds motions that nothing resists are told of above this part of the largest force.
    constexpr double negligible_held_force = 1e-6;

    constexpr double rounding = 1e-12; // of displacements, relative

    /// No load acts along motions that nothing resists, but friction across a gap can: its two sides are at two places.
    void add_held_motions(const StepSolver             &solver,
                          const StepSolver::Answer     &answer,
                          const std::vector<Resultant> &reactions,
                          output::ForceSummary         &sums,
                          Warnings                     &warnings)
    {
      if (solver.n_given_supports() == solver.discrete_scene().supports.size())
        return;
      const auto size = [](const Resultant &sum) { return std::hypot(sum.force[0], sum.force[1]); };
      Resultant  held;
      for (unsigned int h = solver.n_given_supports(); h < solver.discrete_scene().supports.size(); ++h)
        {
          held.force[0] += reactions[h].force[0];
          held.force[1] += reactions[h].force[1];
          held.moment += reactions[h].moment;
        }
      // the least force that can be told from none: rounding of the displacement, over the compliance |PFP|
      double largest =
        rounding * answer.contact->checks.max_displacement / solver.dual().norm() / negligible_held_force;
      for (const auto &load : sums.loads)
        largest = std::max(largest, size(load.sum));
      for (const auto &reaction : reactions)
        largest = std::max(largest, size(reaction));
      if (size(held) <= negligible_held_force * largest)
        return;
      sums.supports.push_back({"held motions", "support", held});
      warnings.emplace(
        "held motions",
        format("friction across gaps leaves %.3g N (%.2g %% of the largest force) along the motions that are set to "
               "zero: it acts on the two sides at two places; add a support against these motions, or mesh the "
               "sides without the gap",
               size(held),
               100 * size(held) / largest));
    }
  } // namespace

  void add_places(const StepSolver &solver, const mechanics::StressResult &stress, output::Summary &summary)
  {
    const auto &scene    = solver.discrete_scene();
    const auto  places   = mechanics::stress_places(solver.mesh(), solver.spaces(), stress);
    const auto  as_place = [&](const mechanics::Peak<dim> &peak) {
      return output::Place{scene.bodies[peak.body].name, {{peak.position[0], peak.position[1]}}};
    };
    summary.results.max_von_mises_at = as_place(places.von_mises);
    summary.error.largest_at         = as_place(places.error);
    if (stress.error_squared > 0)
      summary.error.largest_part = places.error.value * places.error.value / stress.error_squared;
    double nearest = cells_of_singularity * places.size;
    for (const auto &point :
         mechanics::singular_points(scene, solver.mesh(), solver.spaces(), solver.n_given_supports()))
      if (point.body == places.von_mises.body && point.position.distance(places.von_mises.position) < nearest)
        {
          nearest                  = point.position.distance(places.von_mises.position);
          summary.results.singular = point.what;
        }
  }

  std::vector<output::ProbeResult> probe_results(const scene::Scene<dim>            &scene,
                                                 const mechanics::Probes<dim>       &probes,
                                                 const std::vector<Eigen::VectorXd> &u,
                                                 const mechanics::StressResult      &stress)
  {
    std::vector<output::ProbeResult> results;
    for (const auto &points : probes.values(u, stress))
      {
        const auto         &probe = scene.probes[results.size()];
        output::ProbeResult result;
        result.name     = probe.name;
        result.is_point = probe.ends.size() == 1;
        for (const auto &point : points)
          {
            output::ProbeValues values;
            values.distance = point.distance;
            for (unsigned int d = 0; d < dim; ++d)
              {
                values.position[d]     = point.position[d];
                values.displacement[d] = point.displacement[d];
              }
            values.stress    = point.stress;
            values.von_mises = mechanics::von_mises(point.stress[0], point.stress[1], point.stress[2], point.stress[3]);
            result.points.push_back(values);
          }
        results.push_back(std::move(result));
      }
    return results;
  }

  output::ForceSummary forces(const StepSolver         &solver,
                              const StepSolver::Answer &answer,
                              const double              t,
                              Warnings                 &warnings)
  {
    const auto          &scene = solver.discrete_scene();
    output::ForceSummary sums;
    const auto           loads = mechanics::load_resultants(scene, solver.mesh(), solver.spaces(), t);
    unsigned int         next  = 0;
    const auto           take  = [&](const auto &list, const std::string &kind) {
      for (const auto &load : list)
        {
          const auto &sum = loads[next++];
          sums.loads.push_back({load.name, kind, sum.sum});
          if (sum.unresolved)
            warnings.emplace(
              "load " + kind + load.name,
              format("%s %s: its formula changes faster than can be integrated at (%.6g, %.6g), so that its "
                                "resultant may be off; smooth the formula, or refine the mesh there",
                     kind.c_str(),
                     load.name.c_str(),
                     (*sum.unresolved)[0],
                     (*sum.unresolved)[1]));
        }
    };
    take(scene.tractions, "traction");
    take(scene.body_forces, "body force");
    take(scene.point_loads, "point load");
    const unsigned int n_supports = scene.supports.size(), n_holders = n_supports + scene.foundations.size();
    const auto         reactions = contact::reactions(solver.dual(),
                                              solver.held_contacts(),
                                              answer.contact->held_forces,
                                              answer.recovery.multipliers,
                                              n_holders);
    for (unsigned int h = 0; h < solver.n_given_supports(); ++h)
      sums.supports.push_back({scene.supports[h].name, "support", reactions[h]});
    add_held_motions(solver, answer, reactions, sums, warnings);
    for (unsigned int h = n_supports; h < n_holders; ++h)
      sums.foundations.push_back({scene.foundations[h - n_supports].name, "foundation", reactions[h]});
    return sums;
  }

  output::ContactStep gather_contact(const StepSolver              &solver,
                                     const contact::CheckedContact &own,
                                     TotalSlip                     &total_slip)
  {
    const auto          lengths = interface::arc_lengths(solver.discrete_scene(), solver.mesh(), solver.spaces());
    const auto          nodes   = dealii::Utilities::MPI::gather(solver.mesh().comm, own.nodes);
    const auto          keys    = dealii::Utilities::MPI::gather(solver.mesh().comm, own.keys);
    output::ContactStep step;
    for (unsigned int rank = 0; rank < nodes.size(); ++rank)
      for (unsigned int i = 0; i < nodes[rank].size(); ++i)
        {
          auto node       = nodes[rank][i];
          node.arc_length = lengths.at({node.pair, keys[rank][i]});
          node.total_slip = total_slip[{node.pair, keys[rank][i]}] += node.slip;
          step.nodes.push_back(node);
        }
    return step;
  }

  output::ContactNames contact_names(const scene::Scene<dim> &scene)
  {
    output::ContactNames names;
    for (const auto &pair : scene.contacts)
      {
        names.pairs.push_back(pair.name);
        names.slave_bodies.push_back(scene.bodies[pair.slave.body].name);
      }
    return names;
  }
} // namespace slipstick::app
