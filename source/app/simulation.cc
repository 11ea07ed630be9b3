#include <slipstick/app/answer_warnings.h>
#include <slipstick/app/geometry_checks.h>
#include <slipstick/app/held_nodes.h>
#include <slipstick/app/interruption.h>
#include <slipstick/app/report.h>
#include <slipstick/app/restart.h>
#include <slipstick/app/simulation.h>
#include <slipstick/app/step_solver.h>
#include <slipstick/contact/resultants.h>
#include <slipstick/interface/arc_length.h>
#include <slipstick/mechanics/elasticity.h>
#include <slipstick/mechanics/loads.h>
#include <slipstick/mechanics/probes.h>
#include <slipstick/mechanics/singular_points.h>
#include <slipstick/output/conditions.h>
#include <slipstick/output/contact_line.h>
#include <slipstick/output/fields.h>
#include <slipstick/output/history.h>
#include <slipstick/output/probes.h>
#include <slipstick/output/scene_picture.h>

#include <deal.II/base/mpi.h>

#include <boost/serialization/array.hpp>
#include <boost/serialization/vector.hpp>

#include <filesystem>
#include <optional>
#include <set>

namespace slipstick::app
{
  namespace
  {
    constexpr int dim = 2;

    // A singular point raises the stress as far as so many diameters of the cells around the node with the largest one:
    // stresses at nodes are means over cells, and may be largest beside it.
    constexpr double cells_of_singularity = 1.5;

    // Tables are written again after this multiple of the time that writing them took.
    constexpr double pause_over_writing = 10;
    // Forces on what holds motions that nothing resists are told of above this part of the largest force.
    constexpr double negligible_held_force = 1e-6;
    constexpr double no_force              = 1e-30; // [N]: rounding of none, in any scene

    /// Contact nodes of all ranks on rank 0, with their arc lengths.
    /// @param total_slip gets the slip of this step added, on rank 0.
    output::ContactStep gather_contact(const scene::Scene<dim>       &scene,
                                       const mesh::Mesh<dim>         &mesh,
                                       const mechanics::Spaces<dim>  &spaces,
                                       const contact::CheckedContact &own,
                                       TotalSlip                     &total_slip)
    {
      const auto          lengths = interface::arc_lengths(scene, mesh, spaces);
      const auto          nodes   = dealii::Utilities::MPI::gather(mesh.comm, own.nodes);
      const auto          keys    = dealii::Utilities::MPI::gather(mesh.comm, own.keys);
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

    output::TimeSummary times(const StageClock &clock, const double factorization)
    {
      output::TimeSummary time;
      time.startup       = clock.seconds("startup");
      time.mesh          = clock.seconds("mesh");
      time.assembly      = clock.seconds("assembly");
      time.factorization = factorization;
      time.dual_setup    = clock.seconds("dual setup") - factorization;
      time.solve         = clock.seconds("solve");
      time.recovery      = clock.seconds("recovery");
      time.output        = clock.seconds("output");
      time.other         = clock.seconds("other");
      time.total         = clock.total();
      return time;
    }

    /// The summary of a run that ended without equilibrium.
    output::Summary summary_without_equilibrium(const scene::Scene<dim> &scene, const MPI_Comm comm)
    {
      output::Summary summary = empty_summary(scene, comm);
      summary.status          = output::RunStatus::no_equilibrium;
      return summary;
    }

    /// "40 s", "12 min", "3.5 h"
    std::string duration_text(const double seconds)
    {
      constexpr double minute = 60, hour = 3600;
      if (seconds < 2 * minute)
        return format("%.0f s", seconds);
      return seconds < 2 * hour ? format("%.0f min", seconds / minute) : format("%.1f h", seconds / hour);
    }

    std::string set_to_zero(const std::string &motion)
    {
      return "nothing resists " + motion +
             ", and no load acts along it: it is set to zero; add a support or a contact " +
             "against this motion if it matters";
    }

    output::MemorySummary memory(const MPI_Comm comm)
    {
      return {dealii::Utilities::MPI::max(peak_memory_mb(), comm), dealii::Utilities::MPI::sum(peak_memory_mb(), comm)};
    }

    /// Results of the load steps.
    class Run
    {
    public:
      Run(const scene::Scene<dim>       &scene,
          const output::OutputDirectory &directory_,
          const Log                     &log_,
          const MPI_Comm                 comm_)
        : directory(directory_)
        , log(log_)
        , comm(comm_)
        , solver(scene, log_, clock, comm_)
        , scene(solver.discrete_scene())
        , probes(this->scene, solver.mesh(), solver.spaces())
        , warnings(warnings_before(scene, solver.mesh()))
      {}

      ExitStatus solve_and_write(const bool resumes)
      {
        output::Summary summary;
        if (resumes)
          summary = resume();
        else
          solver.build();
        if (!resumes)
          {
            directory.remove_results(); // the scene is accepted: results of an earlier run are no longer valid
            output::write_conditions(directory, scene, solver.mesh(), solver.spaces());
          }
        first_step  = summary.steps.size();
        steps_began = clock.total();
        for (unsigned int step = first_step; step < scene.load_factors.size(); ++step)
          {
            announce(step);
            summary        = load_step(step, summary);
            finished_steps = summary;
            if (summary.status != output::RunStatus::converged)
              break;
            keep(step, summary);
          }
        clock.enter("output");
        write_tables(summary);
        clock.leave();
        summary.time_s    = times(clock, solver.factorization_seconds());
        summary.memory_mb = memory(comm);
        summary.warnings  = warnings;
        output::write_summary(directory, summary);
        if (summary.status == output::RunStatus::converged)
          remove_restart(directory, comm);
        log.line("");
        print_forces(log, scene, summary.results);
        if (prints())
          do_not_tell_when_interrupted();
        print_result(log, summary, directory.path(scene.output.vtu ? "solution.pvd" : "summary.json"));
        return summary.status == output::RunStatus::converged ? ExitStatus::converged : ExitStatus::not_converged;
      }

      /// After a step without equilibrium: the results of the steps before it are kept and marked.
      void write_without_equilibrium()
      {
        if (!finished_steps)
          {
            directory.remove_results();
            output::write_summary(directory, summary_without_equilibrium(scene, comm));
            return;
          }
        write_tables(*finished_steps);
        finished_steps->status    = output::RunStatus::no_equilibrium;
        finished_steps->time_s    = times(clock, solver.factorization_seconds());
        finished_steps->memory_mb = memory(comm);
        finished_steps->warnings  = warnings;
        output::write_summary(directory, *finished_steps);
        log.line(format("finished load steps whose results are kept: %zu", contact_steps.size()));
      }

    private:
      /// Takes over what an earlier run has found. @return its summary.
      output::Summary resume()
      {
        RunState state = read_restart(directory, scene, comm);
        contact_steps  = std::move(state.contact_steps);
        total_slip     = std::move(state.total_slip);
        warnings       = std::move(state.warnings);
        warned_about   = std::move(state.warned_about);
        finished_steps = state.summary;
        kept_steps     = state.summary.steps.size();
        solver.resume(kept_steps - 1, state.solver);
        log.line(format("resumed      after load step %u of %zu", kept_steps, scene.load_factors.size()));
        return std::move(state.summary);
      }

      /// What is left of the run [s], if its steps take as long as those so far; none before the first one has ended.
      std::string time_left(const unsigned int step) const
      {
        if (step == first_step)
          return "";
        const double left = (clock.total() - steps_began) / (step - first_step) * (scene.load_factors.size() - step);
        return ", about " + duration_text(left) + " left";
      }

      bool prints() const
      {
        return dealii::Utilities::MPI::this_mpi_process(comm) == 0;
      }

      /// What is said when the user interrupts load step @p step.
      void announce(const unsigned int step) const
      {
        if (prints())
          tell_when_interrupted(
            format("in load step %u of %zu; ", step + 1, scene.load_factors.size()) +
            (kept_steps > 0
               ? format(
                   "summary.json, history.csv and contact.csv in %s hold the results of the first %u, after which --resume goes on",
                   directory.path("").c_str(),
                   kept_steps)
               : std::string("there are no results")));
      }

      /// Writes the tables of the steps so far while others are still to come, for a run that does not live to see its end;
      /// less often where writing takes longer than solving. Collective.
      void keep(const unsigned int step, output::Summary summary)
      {
        using dealii::Utilities::MPI::broadcast;
        if (step + 1 == scene.load_factors.size() ||
            !broadcast(comm, clock.total() - kept_at > pause_over_writing * writing_time))
          return;
        clock.enter("output");
        const double begin = clock.total();
        write_tables(summary);
        summary.status    = output::RunStatus::unfinished;
        summary.time_s    = times(clock, solver.factorization_seconds());
        summary.memory_mb = memory(comm);
        summary.warnings  = warnings;
        write_restart(directory,
                      scene,
                      {solver.state(), summary, contact_steps, total_slip, warnings, warned_about},
                      comm);
        kept_steps = step + 1;
        output::write_summary(directory, summary);
        announce(step + 1);
        kept_at      = clock.total();
        writing_time = kept_at - begin;
        clock.leave();
      }

      /// Warnings about the answer, one for each kind and pair.
      void warn(const std::map<std::string, std::string> &texts)
      {
        for (const auto &[about, text] : texts)
          if (warned_about.insert(about).second)
            {
              log.line("             warning: " + text);
              warnings.push_back(text);
            }
      }

      /// @param so_far of the steps before.
      output::Summary load_step(const unsigned int step, const output::Summary &so_far)
      {
        const double t = scene.load_factors[step];
        if (scene.load_factors.size() > 1)
          log.line(format("load step    %u of %zu, t = %g%s",
                          step + 1,
                          scene.load_factors.size(),
                          t,
                          time_left(step).c_str()));
        const auto   answer    = solver.solve(step, so_far.solver.hessian_multiplications);
        const auto  &u         = answer->recovery.u;
        const auto  &contact   = *answer->contact;
        const auto  &stress    = *answer->stress;
        const auto  &solution  = solver.solution();
        const double tolerance = tolerance_of(scene.solver, solution);
        print_checks(log, contact.checks, tolerance);
        if (!passes(solution, contact.checks, tolerance))
          print_failure(log, scene, solution, contact.checks, tolerance);
        warn(answer_warnings(scene, solver.mesh(), solver.spaces(), solver.dual(), solution.free, contact.nodes, u));
        warn(held_node_warnings(scene, solver.held_contacts(), contact, comm));

        if (!solver.unheld().empty())
          warn({{"unresisted", set_to_zero(solver.unheld())}});
        if (!answer->recovery.unresisted.empty())
          warn(
            {{"unresisted",
              set_to_zero(tfeti::describe(tfeti::plainest(answer->recovery.unresisted), solver.dual().body_names()))}});
        const auto geometry = judge(scene,
                                    interface::penetrations(scene, solver.mesh(), solver.spaces(), u, t),
                                    contact.checks.max_displacement);
        warn(geometry.warnings);
        if (geometry.failure)
          log.warning(*geometry.failure);

        clock.enter("output");
        auto summary =
          make_summary(scene, solver.mesh(), solver.spaces(), solver.dual(), solution, contact.checks, stress);
        if (geometry.failure)
          summary.status = output::RunStatus::not_converged;
        summary.results.forces = forces(*answer, t);
        add_places(stress, summary);
        summary.results.probes = probe_results(u, stress);
        if (scene.output.vtu)
          {
            output::write_fields(directory, solver.mesh(), solver.spaces(), u, stress, step);
            output::write_pvd(directory, {scene.load_factors.begin(), scene.load_factors.begin() + step + 1});
          }
        if (scene.has_contact())
          {
            contact_steps.push_back(gather_contact(scene, solver.mesh(), solver.spaces(), contact, total_slip));
            contact_steps.back().step = step;
            output::write_contact_vtp(directory, contact_steps.back());
            summary.results.contact = contact::pair_results(contact_steps.back().nodes, contact_names().pairs);
          }
        drop_moments(scene, summary.results);
        clock.leave();
        add_step(so_far, t, summary);
        return summary;
      }

      /// Where stress and error are largest, and whether more than the mesh is in the way there.
      void add_places(const mechanics::StressResult &stress, output::Summary &summary) const
      {
        const auto places   = mechanics::stress_places(solver.mesh(), solver.spaces(), stress);
        const auto as_place = [&](const mechanics::Peak<dim> &peak) {
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

      std::vector<output::ProbeResult> probe_results(const std::vector<Eigen::VectorXd> &u,
                                                     const mechanics::StressResult      &stress) const
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
                values.stress = point.stress;
                values.von_mises =
                  mechanics::von_mises(point.stress[0], point.stress[1], point.stress[2], point.stress[3]);
                result.points.push_back(values);
              }
            results.push_back(std::move(result));
          }
        return results;
      }

      /// Resultants of loads and supports; warns of loads whose formulas no mesh resolves.
      output::ForceSummary forces(const StepSolver::Answer &answer, const double t)
      {
        output::ForceSummary sums;
        const auto           loads = mechanics::load_resultants(scene, solver.mesh(), solver.spaces(), t);
        unsigned int         next  = 0;
        const auto           take  = [&](const auto &list, const std::string &kind) {
          for (const auto &load : list)
            {
              const auto &sum = loads[next++];
              sums.loads.push_back({load.name, kind, sum.sum});
              if (sum.unresolved)
                warn({{"load " + kind + load.name,
                       format("%s %s: its formula changes faster than can be integrated at (%.6g, %.6g), so that its "
                                         "resultant may be off; smooth the formula, or refine the mesh there",
                              kind.c_str(),
                              load.name.c_str(),
                              (*sum.unresolved)[0],
                              (*sum.unresolved)[1])}});
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
        add_held_motions(reactions, sums);
        for (unsigned int h = n_supports; h < n_holders; ++h)
          sums.foundations.push_back({scene.foundations[h - n_supports].name, "foundation", reactions[h]});
        return sums;
      }

      /// No load acts along motions that nothing resists, but friction across a gap can: its two sides are at two places.
      void add_held_motions(const std::vector<Resultant> &reactions, output::ForceSummary &sums)
      {
        const auto size = [](const Resultant &sum) { return std::hypot(sum.force[0], sum.force[1]); };
        Resultant  held;
        for (unsigned int h = solver.n_given_supports(); h < scene.supports.size(); ++h)
          {
            held.force[0] += reactions[h].force[0];
            held.force[1] += reactions[h].force[1];
            held.moment += reactions[h].moment;
          }
        double largest = 0;
        for (const auto &load : sums.loads)
          largest = std::max(largest, size(load.sum));
        for (const auto &reaction : reactions)
          largest = std::max(largest, size(reaction));
        if (size(held) <= std::max(negligible_held_force * largest, no_force))
          return;
        sums.supports.push_back({"held motions", "support", held});
        warn({{"held motions",
               format(
                 "friction across gaps leaves %.3g N (%.2g %% of the largest force) along the motions that are set to "
                 "zero: it acts on the two sides at two places; add a support against these motions, or mesh the "
                 "sides without the gap",
                 size(held),
                 100 * size(held) / largest)}});
      }

      output::ContactNames contact_names() const
      {
        output::ContactNames names;
        for (const auto &pair : scene.contacts)
          {
            names.pairs.push_back(pair.name);
            names.slave_bodies.push_back(scene.bodies[pair.slave.body].name);
          }
        return names;
      }

      void write_tables(const output::Summary &summary) const
      {
        output::write_history(directory, summary.steps);
        output::write_probes(directory, summary.steps);
        output::write_convergence(directory, solver.convergence());
        directory.write_from_root("parameters.prm", [&](std::ostream &out) { out << scene.parameters; });
        if (scene.has_contact())
          output::write_contact_csv(directory, contact_names(), contact_steps);
      }

      const output::OutputDirectory   &directory;
      const Log                       &log;
      const MPI_Comm                   comm;
      StageClock                       clock;
      StepSolver                       solver;
      const scene::Scene<dim>         &scene; // with the contact pairs that are found
      mechanics::Probes<dim>           probes;
      std::vector<output::ContactStep> contact_steps;
      TotalSlip                        total_slip;
      std::vector<std::string>         warnings;
      std::set<std::string>            warned_about;
      std::optional<output::Summary>   finished_steps;   // of all load steps that have ended
      unsigned int                     first_step   = 0; // of this process
      double                           steps_began  = 0; // [s]
      unsigned int                     kept_steps   = 0; // in the tables on the disk
      double                           kept_at      = 0; // when they were written [s]
      double                           writing_time = 0; // that this took [s]
    };
  } // namespace

  void check_scene(const scene::Scene<dim> &scene, const std::string &picture, const Log &log, const MPI_Comm comm)
  {
    StageClock clock;
    StepSolver solver(scene, log, clock, comm);
    mechanics::Probes<dim>(scene, solver.mesh(), solver.spaces());
    solver.build();
    if (!solver.unheld().empty())
      log.line("warning: " + set_to_zero(solver.unheld()));
    log.line(std::string("the scene is complete: every subdomain has its rigid motions as kernel") +
             (solver.unheld().empty() ? ", every body is held by supports or contact" : ""));
    if (picture.empty())
      return;
    auto as_given = solver.discrete_scene();
    as_given.supports.resize(solver.n_given_supports());
    const std::filesystem::path   file(picture);
    const output::OutputDirectory directory(file.has_parent_path() ? file.parent_path().string() : ".", comm);
    output::write_scene_picture(directory, file.filename().string(), as_given, solver.mesh(), solver.spaces());
    log.line("picture of the scene: " + picture);
  }

  ExitStatus run(const scene::Scene<dim> &scene,
                 const std::string       &output_directory,
                 const bool               resumes,
                 const Log               &log,
                 const MPI_Comm           comm)
  {
    const output::OutputDirectory directory(output_directory, comm);
    std::optional<Run>            steps;
    try
      {
        steps.emplace(scene, directory, log, comm);
        return steps->solve_and_write(resumes);
      }
    catch (const InputError &) // some of it shows in meshes and formulas only
      {
        directory.remove_if_new();
        throw;
      }
    catch (const NoEquilibrium &) // on all ranks alike
      {
        if (steps)
          steps->write_without_equilibrium();
        throw;
      }
  }
} // namespace slipstick::app
