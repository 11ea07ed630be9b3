#include <slipstick/app/contact_faces.h>
#include <slipstick/app/step_results.h>
#include <slipstick/base/gather.h>
#include <slipstick/base/text.h>
#include <slipstick/contact/resultants.h>
#include <slipstick/interface/arc_length.h>
#include <slipstick/mechanics/elasticity.h>
#include <slipstick/mechanics/loads.h>
#include <slipstick/mechanics/singular_points.h>

#include <deal.II/base/mpi.h>

#include <boost/serialization/array.hpp>
#include <boost/serialization/vector.hpp>

#include <algorithm>
#include <cmath>

namespace slipstick::app
{
  namespace
  {
    // Radius of influence of a singular point, in diameters of the cells around the node with the largest stress: nodal
    // stresses are means over cells, so that the largest may be at a node adjacent to the singular point.
    constexpr double cells_of_singularity = 1.5;

    // What holds motions that nothing resists is warned of if above this part of the largest force.
    constexpr double warned_still_load = 1e-3;

    template <int dim>
    std::array<double, 3> in_space(const dealii::Tensor<1, dim> &x)
    {
      std::array<double, 3> all{{0, 0, 0}};
      for (unsigned int d = 0; d < dim; ++d)
        all[d] = x[d];
      return all;
    }

    double size(const Resultant &sum)
    {
      return std::hypot(sum.force[0], sum.force[1], sum.force[2]);
    }

    /// Adds what holds motions that nothing resists. No load acts along them, but friction across a gap may turn both
    /// bodies: its forces act at points of each side, which the loads bring together without turning anything.
    template <int dim>
    void add_still_forces(const StepSolver<dim>        &solver,
                          const StepSolution           &answer,
                          const std::vector<Resultant> &reactions,
                          output::ForceSummary         &sums,
                          Warnings                     &warnings)
    {
      const double load = solver.still_load();
      if (load == 0)
        return;
      sums.supports.push_back({"held motions", "support", solver.still_forces()});
      double largest = 0;
      for (const auto &node : answer.contact->nodes)
        largest += std::abs(node.pressure) * node.area;
      largest = dealii::Utilities::MPI::sum(largest, solver.dual().communicator());
      for (const auto &of_load : sums.loads)
        largest = std::max(largest, size(of_load.sum));
      for (const auto &reaction : reactions)
        largest = std::max(largest, size(reaction));
      if (load > warned_still_load * largest)
        warnings.emplace("held motions",
                         format("the motions that are set to zero are held by %.3g N, %.2g %% of the largest force: "
                                "friction acts on two sides across a gap, and the bodies would turn when it closes; "
                                "add a support against these motions, or mesh the sides without the gap",
                                load,
                                100 * load / largest));
    }

    using NodeOfPair = TotalSlip::key_type;
  } // namespace

  template <int dim>
  void add_places(const StepSolver<dim> &solver, const mechanics::StressResult &stress, output::Summary &summary)
  {
    const auto &scene    = solver.discrete_scene();
    const auto  places   = mechanics::stress_places(solver.mesh(), solver.spaces(), stress);
    const auto  as_place = [&](const mechanics::Peak<dim> &peak) {
      return output::Place{scene.bodies[peak.body].name, in_space(peak.position)};
    };
    summary.results.max_von_mises_at = as_place(places.von_mises);
    summary.error.largest_at         = as_place(places.error);
    if (stress.error_squared > 0)
      summary.error.largest_part = places.error.value * places.error.value / stress.error_squared;
    double nearest = cells_of_singularity * places.size;
    for (const auto &point :
         mechanics::singular_points(scene, solver.mesh(), solver.spaces(), solver.n_given_supports()))
      if (point.body == places.von_mises.body && point.distance(places.von_mises.position) < nearest)
        {
          nearest                  = point.distance(places.von_mises.position);
          summary.results.singular = point.what;
        }
  }

  template <int dim>
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
            values.distance     = point.distance;
            values.position     = in_space(point.position);
            values.displacement = in_space(point.displacement);
            values.stress       = point.stress;
            values.von_mises    = mechanics::von_mises<dim>(point.stress);
            result.points.push_back(values);
          }
        results.push_back(std::move(result));
      }
    return results;
  }

  template <int dim>
  output::ForceSummary forces(const StepSolver<dim> &solver,
                              const StepSolution    &answer,
                              const double           t,
                              Warnings              &warnings)
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
            warnings.emplace("load " + kind + load.name,
                             format("%s %s: its formula changes faster than can be integrated at %s, so that its "
                                               "resultant may be off; smooth the formula, or refine the mesh there",
                                    kind.c_str(),
                                    load.name.c_str(),
                                    point_text(*sum.unresolved, dim).c_str()));
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
    add_still_forces(solver, answer, reactions, sums, warnings);
    for (unsigned int h = n_supports; h < n_holders; ++h)
      sums.foundations.push_back({scene.foundations[h - n_supports].name, "foundation", reactions[h]});
    return sums;
  }

  template <int dim>
  output::ContactStep gather_contact(const StepSolver<dim>           &solver,
                                     const contact::CheckedContact   &own,
                                     TotalSlip                       &total_slip,
                                     std::vector<mechanics::NodeKey> &keys_of_nodes)
  {
    const auto                                              &scene = solver.discrete_scene();
    const auto                                               nodes = gather(solver.mesh().comm, own.nodes);
    const auto                                               keys  = gather(solver.mesh().comm, own.keys);
    std::vector<std::pair<contact::ContactNode, NodeOfPair>> all;
    for (unsigned int rank = 0; rank < nodes.size(); ++rank)
      for (unsigned int i = 0; i < nodes[rank].size(); ++i)
        {
          all.emplace_back(nodes[rank][i], NodeOfPair(nodes[rank][i].pair, keys[rank][i]));
          auto &node  = all.back().first;
          auto &total = total_slip[all.back().second];
          if (dim == 2)
            node.total_slip = total[0] += node.slip;
          for (unsigned int d = 0; d < 3 && dim == 3; ++d)
            total[d] += node.slip_vector[d];
          if (dim == 3)
            node.total_slip = std::hypot(total[0], total[1], total[2]);
        }
    output::ContactStep step;
    if constexpr (dim == 2)
      {
        const auto lengths = interface::arc_lengths(scene, solver.mesh(), solver.spaces());
        for (auto &[node, key] : all)
          {
            node.arc_length = lengths.at(key);
            step.nodes.push_back(node);
          }
      }
    else
      {
        std::sort(all.begin(), all.end(), [](const auto &a, const auto &b) {
          return std::tie(a.first.pair, a.first.position) < std::tie(b.first.pair, b.first.position);
        });
        std::map<NodeOfPair, std::int64_t> number;
        for (const auto &[node, key] : all)
          {
            number.emplace(key, step.nodes.size());
            step.nodes.push_back(node);
          }
        step.faces = contact_faces(scene, solver.mesh(), solver.spaces(), number);
      }
    keys_of_nodes.clear();
    for (const auto &[node, key] : all)
      keys_of_nodes.push_back(key.second);
    return step;
  }

  template output::ForceSummary forces(const StepSolver<2> &, const StepSolution &, const double, Warnings &);
  template void                 add_places(const StepSolver<2> &, const mechanics::StressResult &, output::Summary &);
  template std::vector<output::ProbeResult> probe_results(const scene::Scene<2> &,
                                                          const mechanics::Probes<2> &,
                                                          const std::vector<Eigen::VectorXd> &,
                                                          const mechanics::StressResult &);
  template output::ContactStep              gather_contact(const StepSolver<2> &,
                                                           const contact::CheckedContact &,
                                                           TotalSlip &,
                                                           std::vector<mechanics::NodeKey> &);
  template output::ForceSummary forces(const StepSolver<3> &, const StepSolution &, const double, Warnings &);
  template void                 add_places(const StepSolver<3> &, const mechanics::StressResult &, output::Summary &);
  template std::vector<output::ProbeResult> probe_results(const scene::Scene<3> &,
                                                          const mechanics::Probes<3> &,
                                                          const std::vector<Eigen::VectorXd> &,
                                                          const mechanics::StressResult &);
  template output::ContactStep              gather_contact(const StepSolver<3> &,
                                                           const contact::CheckedContact &,
                                                           TotalSlip &,
                                                           std::vector<mechanics::NodeKey> &);
} // namespace slipstick::app
