#include <slipstick/app/adaptivity.h>
#include <slipstick/app/answer_warnings.h>
#include <slipstick/app/error_bars.h>
#include <slipstick/app/geometry_checks.h>
#include <slipstick/app/held_nodes.h>
#include <slipstick/app/interruption.h>
#include <slipstick/app/report.h>
#include <slipstick/app/restart.h>
#include <slipstick/app/simulation.h>
#include <slipstick/app/step_solver.h>
#include <slipstick/base/memory.h>
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

#include <cmath>
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
      /// @param wanted error bars of these, after the last load step; with an empty list of all; nothing: none.
      /// @param refinement of single cells, if any.
      Run(const scene::Scene<dim>                &scene,
          const output::OutputDirectory          &directory_,
          const Log                              &log_,
          const MPI_Comm                          comm_,
          std::optional<std::vector<std::string>> wanted_    = {},
          mesh::Refinement                       *refinement = nullptr)
        : directory(directory_)
        , log(log_)
        , comm(comm_)
        , wanted(std::move(wanted_))
        , solver(scene, log_, clock, comm_, wanted.has_value(), refinement)
        , scene(solver.discrete_scene())
        , probes(this->scene, solver.mesh(), solver.spaces())
        , warnings(warnings_before(scene, solver.mesh()))
      {}

      /// @return the summary, which rank 0 knows completely.
      const output::Summary &solve_and_write(const bool resumes)
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
        finished_steps = std::move(summary);
        return *finished_steps;
      }

      /// What was found, at the end of a run.
      void print(const Log &to) const
      {
        const auto &summary = *finished_steps;
        to.line("");
        print_forces(to, scene, summary.results);
        if (prints())
          do_not_tell_when_interrupted();
        print_bars(to, summary.error_bars);
        print_result(to, summary, directory.path(scene.output.vtu ? "solution.pvd" : "summary.json"));
      }

      /// Those about input and answer.
      void print_warnings(const Log &to) const
      {
        for (const std::string &text : warnings)
          to.line("             warning: " + text);
      }

      /// Says in the summary what became of an accuracy that was asked for.
      void finish(const std::vector<output::MeshRow> &meshes,
                  const std::vector<std::string>     &notes,
                  const std::string                  &missed)
      {
        finished_steps->meshes    = meshes;
        finished_steps->time_s    = times(clock, solver.factorization_seconds());
        finished_steps->memory_mb = memory(comm);
        finished_steps->warnings.insert(finished_steps->warnings.end(), notes.begin(), notes.end());
        if (!missed.empty())
          {
            finished_steps->status = output::RunStatus::not_converged;
            finished_steps->warnings.push_back(missed);
          }
        output::write_summary(directory, *finished_steps);
      }

      /// Of the last load step.
      const mechanics::StressResult &stress() const
      {
        return *last->stress;
      }
      const std::vector<GoalError> &goals() const
      {
        return errors;
      }
      const mesh::Mesh<dim> &mesh() const
      {
        return solver.mesh();
      }
      std::vector<LeftOut> point_forces() const
      {
        return app::point_forces(scene, solver.mesh(), solver.spaces(), solver.n_given_supports());
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
        summary.status    = output::RunStatus::unfinished;
        summary.time_s    = times(clock, solver.factorization_seconds());
        summary.memory_mb = memory(comm);
        summary.warnings  = warnings;
        write_restart(directory,
                      scene,
                      {solver.state(), summary, contact_steps, total_slip, warnings, warned_about},
                      comm);
        write_tables(summary); // these last, next to each other: they agree unless a signal comes right here
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
        last.reset();
        auto         answer    = solver.solve(step, so_far.solver.hessian_multiplications);
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
        last = std::move(answer);
        if (wanted && step + 1 == scene.load_factors.size() && summary.status == output::RunStatus::converged)
          estimate_errors(t, summary);
        return summary;
      }

      /// After the last load step.
      void estimate_errors(const double t, output::Summary &summary)
      {
        clock.enter("recovery");
        errors = goal_errors(solver, probes, *last, t, *wanted);
        summary.error_bars =
          error_bars(errors,
                     summary.results,
                     contact_steps.empty() ? std::vector<contact::ContactNode>() : contact_steps.back().nodes,
                     scene.contacts);
        clock.leave();
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

      const output::OutputDirectory          &directory;
      const Log                              &log;
      const MPI_Comm                          comm;
      std::optional<std::vector<std::string>> wanted; // error bars
      StageClock                              clock;
      StepSolver                              solver;
      const scene::Scene<dim>                &scene; // with the contact pairs that are found
      mechanics::Probes<dim>                  probes;
      std::unique_ptr<StepSolver::Answer>     last;   // load step
      std::vector<GoalError>                  errors; // of its figures
      std::vector<output::ContactStep>        contact_steps;
      TotalSlip                               total_slip;
      std::vector<std::string>                warnings;
      std::set<std::string>                   warned_about;
      std::optional<output::Summary>          finished_steps;   // of all load steps that have ended
      unsigned int                            first_step   = 0; // of this process
      double                                  steps_began  = 0; // [s]
      unsigned int                            kept_steps   = 0; // in the tables on the disk
      double                                  kept_at      = 0; // when they were written [s]
      double                                  writing_time = 0; // that this took [s]
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

  namespace
  {
    /// Meshes that are refined until the accuracy is reached.
    class Refining
    {
    public:
      Refining(const scene::Scene<dim>        &scene_,
               const scene::AdaptivityOptions &options_,
               const output::OutputDirectory  &directory_,
               const Log                      &log_,
               const MPI_Comm                  comm_)
        : scene(scene_)
        , options(options_)
        , directory(directory_)
        , log(log_)
        , quiet(comm_, Verbosity::quiet)
        , comm(comm_)
      {}

      ExitStatus run(std::optional<Run> &steps)
      {
        print_header(log, scene, comm);
        log.line(format("accuracy     %g %% of %s is to be reached, with at most %u meshes and %u unknowns",
                        100 * options.accuracy,
                        what().c_str(),
                        options.max_meshes,
                        options.max_unknowns));
        for (;;)
          {
            steps.reset();
            std::optional<std::vector<std::string>> wanted;
            if (!options.goals.empty())
              wanted = options.goals;
            steps.emplace(scene, directory, quiet, comm, wanted, &refinement);
            const auto &summary = steps->solve_and_write(false);
            const bool  solved  = summary.status == output::RunStatus::converged;
            if (rows.empty() && options.goals.empty())
              leave_out(steps->point_forces());
            if (solved)
              add(*steps, summary);
            const std::string missed = solved ? why_to_stop(*steps, summary) : "a mesh was not solved";
            if (!solved || reached || !missed.empty())
              {
                steps->finish(rows, notes, reached ? "" : missed);
                steps->print_warnings(log);
                steps->print(log);
                if (!reached)
                  log.warning(missed);
                return reached ? ExitStatus::converged : ExitStatus::not_converged;
              }
          }
      }

    private:
      std::string what() const
      {
        std::string names;
        for (const std::string &goal : options.goals)
          names += (names.empty() ? "" : ", ") + goal;
        return names.empty() ? "the energy norm" : names;
      }

      void leave_out(std::vector<LeftOut> places)
      {
        left_out = std::move(places);
        for (const auto &place : left_out)
          {
            notes.push_back(
              format("the accuracy leaves out what is within %.3g mm of (%.6g, %.6g) of body %s, %s: the energy "
                     "is infinite there; spread the force over an edge to have it estimated",
                     place.radius,
                     place.position[0],
                     place.position[1],
                     scene.bodies[place.body].name.c_str(),
                     place.what.c_str()));
            log.line("             warning: " + notes.back());
          }
      }

      void add(const Run &steps, const output::Summary &summary)
      {
        output::MeshRow row;
        row.cells        = summary.problem.cells;
        row.unknowns     = summary.problem.primal_dofs;
        row.energy_error = summary.error.estimate_energy_relative;
        const auto worst = options.goals.empty() ? std::optional<double>(std::sqrt(errors_of(steps).total))
                                                 : worst_error(summary.error_bars, options.goals);
        is_known         = dealii::Utilities::MPI::broadcast(comm, worst.has_value());
        row.error        = dealii::Utilities::MPI::broadcast(comm, worst.value_or(0.));
        row.seconds      = summary.time_s.total;
        rows.push_back(row);
        if (rows.size() == 1)
          log.line("              mesh      cells   unknowns  energy norm   error    time [s]");
        reached = is_known && row.error <= options.accuracy && summary.status == output::RunStatus::converged;
        log.line(format("             %5zu %10llu %10llu %10.2g %% %8s %10.2f",
                        rows.size(),
                        static_cast<unsigned long long>(row.cells),
                        static_cast<unsigned long long>(row.unknowns),
                        100 * row.energy_error,
                        is_known ? format("%.2g %%", 100 * row.error).c_str() : "none",
                        row.seconds));
      }

      /// Marks the cells of the next mesh. @return why there is none; empty: there is one, or none is needed.
      std::string why_to_stop(const Run &steps, const output::Summary &summary)
      {
        if (reached)
          return "";
        const std::string so_far =
          format("the accuracy of %g %% of %s is not reached: ", 100 * options.accuracy, what().c_str()) +
          (is_known ? format("the error is %.2g %% after %zu meshes", 100 * rows.back().error, rows.size())
                    : format("after %zu meshes there is no estimate", rows.size()));
        if (rows.size() >= options.max_meshes)
          return so_far + "; allow more of them (Adaptivity/Max meshes), or begin with a finer one";
        auto       cells    = options.goals.empty() || !is_known ? errors_of(steps)
                                                                 : errors_of_goals(steps.goals(), options.accuracy, comm);
        const auto n_marked = mark(steps.mesh(), cells, refinement);
        // nine cells for one, and templates around them
        constexpr double cells_for_one = 12;
        const double     growth        = 1 + cells_for_one * n_marked / summary.problem.cells;
        if (n_marked == 0)
          return so_far + "; no cell is left that refinement would help";
        if (growth * rows.back().unknowns > options.max_unknowns)
          return so_far + format("; the next mesh may have %.2g unknowns, allowed are %u (Adaptivity/Max unknowns)",
                                 growth * rows.back().unknowns,
                                 options.max_unknowns);
        const double needed = dealii::Utilities::MPI::broadcast(comm, summary.memory_mb.peak_total * growth);
        const double free =
          dealii::Utilities::MPI::broadcast(comm,
                                            free_memory_mb(dealii::Utilities::MPI::n_mpi_processes(comm)) +
                                              summary.memory_mb.peak_total);
        if (needed > free)
          return so_far + format("; the next mesh may need %.0f MB of memory, and %.0f MB are free", needed, free);
        return "";
      }

      /// In the energy norm; on the way to a goal without an estimate as much as is useful.
      CellErrors errors_of(const Run &steps) const
      {
        return energy_errors(steps.mesh(), steps.stress(), left_out, options.goals.empty() ? options.accuracy : 0.);
      }

      const scene::Scene<dim>        &scene;
      const scene::AdaptivityOptions &options;
      const output::OutputDirectory  &directory;
      const Log                      &log;
      const Log                       quiet;
      const MPI_Comm                  comm;
      mesh::Refinement                refinement;
      std::vector<output::MeshRow>    rows;
      std::vector<LeftOut>            left_out;
      std::vector<std::string>        notes;
      bool                            reached = false, is_known = false;
    };
  } // namespace

  ExitStatus run(const scene::Scene<dim>        &scene,
                 const scene::AdaptivityOptions &adaptivity,
                 const std::string              &output_directory,
                 const bool                      resumes,
                 const Log                      &log,
                 const MPI_Comm                  comm)
  {
    if (resumes && adaptivity.refines())
      throw InputError("--resume: a run that refines its meshes cannot go on",
                       "start it anew, without --resume, or give Accuracy without a percentage");
    const output::OutputDirectory directory(output_directory, comm);
    std::optional<Run>            steps;
    try
      {
        if (adaptivity.refines())
          return Refining(scene, adaptivity, directory, log, comm).run(steps);
        std::optional<std::vector<std::string>> wanted;
        if (adaptivity.error_bars)
          wanted.emplace();
        steps.emplace(scene, directory, log, comm, wanted);
        const bool converged = steps->solve_and_write(resumes).status == output::RunStatus::converged;
        steps->print(log);
        return converged ? ExitStatus::converged : ExitStatus::not_converged;
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
