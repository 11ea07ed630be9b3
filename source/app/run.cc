#include <slipstick/app/contact_cells.h>
#include <slipstick/app/contact_profile.h>
#include <slipstick/app/error_bars.h>
#include <slipstick/app/formula_warnings.h>
#include <slipstick/app/geometry_checks.h>
#include <slipstick/app/held_nodes.h>
#include <slipstick/app/interruption.h>
#include <slipstick/app/names.h>
#include <slipstick/app/report.h>
#include <slipstick/app/run.h>
#include <slipstick/app/solution_warnings.h>
#include <slipstick/base/memory.h>
#include <slipstick/contact/equilibrium_limit.h>
#include <slipstick/output/conditions.h>
#include <slipstick/output/contact_displacement.h>
#include <slipstick/output/fields.h>
#include <slipstick/output/history.h>
#include <slipstick/output/probes.h>
#include <slipstick/scene/adaptivity.h>
#include <slipstick/tfeti/diagnosis.h>

#include <deal.II/base/mpi.h>

namespace slipstick::app
{
  namespace
  {
    // Tables are written again after this multiple of the time needed to write them.
    constexpr double pause_over_writing = 10;

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
    template <int dim>
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

    output::MemorySummary memory(const MPI_Comm comm)
    {
      return {dealii::Utilities::MPI::max(peak_memory_mb(), comm), dealii::Utilities::MPI::sum(peak_memory_mb(), comm)};
    }
  } // namespace

  std::string set_to_zero(const std::string &motion)
  {
    return "nothing resists " + motion + ", and no load acts along it: it is set to zero; add a support or a contact " +
           "against this motion if it matters";
  }

  template <int dim>
  Run<dim>::Run(const scene::Scene<dim>       &scene_,
                const output::OutputDirectory &directory_,
                const Log                     &log_,
                const MPI_Comm                 comm_,
                std::optional<RequestedBars>   wanted_,
                mesh::Refinement              *refinement)
    : directory(directory_)
    , log(log_)
    , comm(comm_)
    , wanted(std::move(wanted_))
    , refines(refinement)
    , solver(scene_, log_, clock, comm_, wanted.has_value(), refinement)
    , scene(solver.discrete_scene())
    , probes(scene, solver.mesh(), solver.spaces())
    , warnings(warnings_before(scene_, solver.mesh()))
  {}

  template <int dim>
  const output::Summary &Run<dim>::solve_and_write(const bool resumes)
  {
    output::Summary summary;
    if (resumes)
      summary = resume();
    else
      solver.build();
    if (!resumes)
      {
        directory.remove_results(); // the scene is valid: results of an earlier run are removed
        output::write_conditions(directory, scene, solver.mesh(), solver.spaces());
        warn(finer_slave_warnings(scene, solver.mesh(), solver.dual().constraints()));
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
    describe_run(summary);
    write(summary);
    clock.leave();
    describe_run(summary);
    output::write_summary(directory, summary); // with the time of writing
    if (summary.status == output::RunStatus::converged)
      remove_restart(directory, comm);
    finished_steps = std::move(summary);
    return *finished_steps;
  }

  template <int dim>
  void Run<dim>::print(const Log &to) const
  {
    const auto &summary = *finished_steps;
    to.line("");
    print_forces(to, scene, summary.results);
    if (prints())
      do_not_tell_when_interrupted();
    print_bars(to, summary.error_bars);
    if (!refines)
      print_inaccurate(to, summary.error_bars, scene::goals_of_presets(scene), scene::accuracy_of(scene.accuracy));
    print_result(to, summary, directory.path(scene.output.vtu ? "solution.pvd" : "summary.json"));
  }

  template <int dim>
  void Run<dim>::print_warnings(const Log &to) const
  {
    for (const std::string &text : warnings)
      to.remark("warning: " + text);
  }

  template <int dim>
  void Run<dim>::finish(const std::vector<output::MeshRow> &meshes,
                        const std::vector<std::string>     &notes,
                        const std::string                  &missed)
  {
    describe_run(*finished_steps);
    finished_steps->meshes = meshes;
    finished_steps->warnings.insert(finished_steps->warnings.end(), notes.begin(), notes.end());
    if (!missed.empty())
      {
        finished_steps->is_inaccurate = finished_steps->status == output::RunStatus::converged;
        finished_steps->status        = output::RunStatus::not_converged;
        finished_steps->warnings.push_back(missed);
      }
    output::write_summary(directory, *finished_steps);
  }

  template <int dim>
  std::vector<LeftOut<dim>> Run<dim>::point_forces() const
  {
    return app::point_forces(scene, solver.mesh(), solver.spaces(), solver.n_given_supports());
  }

  template <int dim>
  std::size_t Run<dim>::mark_coarse_masters(const std::vector<std::string> &goals, mesh::Refinement &refinement) const
  {
    return app::mark_coarse_masters(scene,
                                    solver.mesh(),
                                    contact_steps.empty() ? std::vector<contact::ContactNode>()
                                                          : contact_steps.back().nodes,
                                    goals,
                                    refinement);
  }

  template <int dim>
  bool Run<dim>::is_unresolved(const std::string &goal) const
  {
    return std::any_of(unresolved_pairs.begin(), unresolved_pairs.end(), [&](const unsigned int k) {
      const std::string beginning = scene.contacts[k].name + ".";
      return goal.compare(0, beginning.size(), beginning) == 0;
    });
  }

  template <int dim>
  std::size_t Run<dim>::mark_unresolved_contacts(mesh::Refinement &refinement) const
  {
    return unresolved_pairs.empty()
             ? 0
             : mark_contact_zones(scene, solver.mesh(), contact_steps.back().nodes, unresolved_pairs, refinement);
  }

  template <int dim>
  contact::ContactOfMesh Run<dim>::contact_of_first_step() const
  {
    if (contact_steps.empty())
      return {};
    return {contact_names(scene).pairs, dealii::Utilities::MPI::broadcast(comm, contact_steps.front().nodes)};
  }

  template <int dim>
  void Run<dim>::write_without_equilibrium()
  {
    if (!finished_steps)
      {
        directory.remove_results();
        output::write_summary(directory, summary_without_equilibrium(scene, comm));
        return;
      }
    finished_steps->status = output::RunStatus::no_equilibrium;
    describe_run(*finished_steps);
    write(*finished_steps);
    log.line(format("finished load steps whose results are kept: %zu", contact_steps.size()));
  }

  template <int dim>
  output::Summary Run<dim>::resume()
  {
    RunState state = read_restart(directory, scene, comm);
    contact_steps  = std::move(state.contact_steps);
    total_slip     = std::move(state.total_slip);
    warnings       = std::move(state.warnings);
    warned_about   = std::move(state.warned_about);
    finished_steps = state.summary;
    kept_steps     = state.summary.steps.size();
    largest_force  = state.largest_force;
    solver.resume(state.solver);
    log.line(format("resumed      after load step %u of %zu", kept_steps, scene.load_factors.size()));
    return std::move(state.summary);
  }

  template <int dim>
  std::string Run<dim>::time_left(const unsigned int step) const
  {
    if (step == first_step)
      return "";
    const double left = (clock.total() - steps_began) / (step - first_step) * (scene.load_factors.size() - step);
    return ", about " + duration_text(left) + " left";
  }

  template <int dim>
  bool Run<dim>::prints() const
  {
    return dealii::Utilities::MPI::this_mpi_process(comm) == 0;
  }

  template <int dim>
  void Run<dim>::announce(const unsigned int step) const
  {
    if (prints())
      tell_when_interrupted(
        format("in load step %u of %zu; ", step + 1, scene.load_factors.size()) +
        (kept_steps > 0
           ? format(
               "summary.json, history.csv and contact.csv in %s hold the results of the first %u, from which --resume continues",
               directory.path("").c_str(),
               kept_steps)
           : std::string("there are no results")));
  }

  template <int dim>
  void Run<dim>::keep(const unsigned int step, output::Summary summary)
  {
    using dealii::Utilities::MPI::broadcast;
    if (step + 1 == scene.load_factors.size() ||
        !broadcast(comm, clock.total() - kept_at > pause_over_writing * writing_time))
      return;
    clock.enter("output");
    const double begin = clock.total();
    summary.status     = output::RunStatus::unfinished;
    describe_run(summary);
    write_restart(directory,
                  scene,
                  {solver.state(), summary, contact_steps, total_slip, largest_force, warnings, warned_about},
                  comm);
    write(summary);
    kept_steps = step + 1;
    announce(step + 1);
    kept_at      = clock.total();
    writing_time = kept_at - begin;
    clock.leave();
  }

  template <int dim>
  void Run<dim>::warn(const Warnings &texts)
  {
    for (const auto &[about, text] : texts)
      if (warned_about.insert(about).second)
        {
          log.remark("warning: " + text);
          warnings.push_back(text);
        }
  }

  template <int dim>
  output::Summary Run<dim>::load_step(const unsigned int step, const output::Summary &so_far)
  {
    const double t = scene.load_factors[step];
    if (scene.load_factors.size() > 1)
      log.line(
        format("load step    %u of %zu, t = %g%s", step + 1, scene.load_factors.size(), t, time_left(step).c_str()));
    last.reset();
    auto        answer   = solver.solve(step, so_far.solver.hessian_multiplications);
    const auto &contact  = *answer->contact;
    const auto &stress   = *answer->stress;
    const bool  is_right = warn_of_answer(t, *answer);
    Warnings    about_forces;

    clock.enter("output");
    auto summary =
      make_summary(scene, solver.mesh(), solver.spaces(), solver.dual(), solver.solution(), contact.checks, stress);
    if (!is_right)
      summary.status = output::RunStatus::not_converged;
    if (summary.status == output::RunStatus::not_converged)
      tfeti::refuse_stiffnesses_too_far_apart(solver.dual());
    summary.results.forces = forces(solver, *answer, t, about_forces);
    warn(about_forces);
    add_places(solver, stress, summary);
    for (unsigned int k = 0; k < scene.pretensions.size(); ++k)
      summary.results.pretensions.push_back({scene.pretensions[k].name,
                                             solver.tightening().tensions()[k],
                                             solver.tightening().shortening()[k],
                                             solver.tightening().is_given(k)});
    summary.results.probes = probe_results(scene, probes, answer->recovery.u, stress);
    write_fields(step, *answer);
    if (scene.has_contact())
      {
        std::vector<mechanics::NodeKey> nodes;
        contact_steps.push_back(gather_contact(solver, contact, total_slip, nodes));
        contact_steps.back().step = step;
        output::write_contact_vtp(
          directory,
          contact_steps.back(),
          dim,
          output::contact_displacement(solver.mesh(), solver.spaces(), answer->recovery.u, nodes));
        output::write_contact_pvd(directory, {scene.load_factors.begin(), scene.load_factors.begin() + step + 1});
        auto &pairs = summary.results.contact;
        pairs       = contact::pair_results(contact_steps.back().nodes, contact_names(scene).pairs, dim);
        for (std::size_t k = 0; k < contact.checks.traction_errors.size(); ++k)
          pairs[k].algebraic_error = contact.checks.traction_errors[k];
      }
    largest_force = std::max(largest_force, app::largest_force(summary.results));
    if (scene.has_contact() && step + 1 == scene.load_factors.size())
      {
        const auto found = unresolved_contacts(contact_steps.back().nodes,
                                               scene.contacts,
                                               largest_force,
                                               scene.plane_state == scene::PlaneState::axisymmetric,
                                               comm);
        unresolved_pairs = found.pairs;
        if (!found.warning.empty())
          warn({{"resolution", found.warning}});
      }
    drop_moments(scene, summary.results);
    clock.leave();
    add_step(so_far, t, summary);
    last = std::move(answer);
    if (wanted && step + 1 == scene.load_factors.size() && summary.status == output::RunStatus::converged)
      estimate_errors(t, summary);
    return summary;
  }

  template <int dim>
  bool Run<dim>::warn_of_answer(const double t, const StepSolution &answer)
  {
    const auto  &u         = answer.recovery.u;
    const auto  &contact   = *answer.contact;
    const auto  &solution  = solver.solution();
    const double tolerance = tolerance_of(scene.solver, solution);
    print_checks(log, contact.checks, tolerance);
    if (!passes(solution, contact.checks, tolerance))
      print_failure(log, scene, solution, contact.checks, tolerance);
    warn(solution_warnings(scene,
                           solver.mesh(),
                           solver.spaces(),
                           solver.dual(),
                           answer.recovery.multipliers,
                           solution.free,
                           contact.nodes,
                           solver.elastic_part(u)));
    warn(held_node_warnings(scene, solver.held_contacts(), contact, comm));
    if (scene.has_contact())
      if (const std::string text = contact::limit_warning(solver.dual(),
                                                          contact::SlipLaw(scene, solver.dual(), t),
                                                          answer.recovery.multipliers);
          !text.empty())
        warn({{"limit", text}});
    warn(formula_warnings(scene, solver.mesh(), solver.spaces(), t, contact.checks.max_displacement));
    if (!solver.unheld().empty())
      warn({{"unresisted", set_to_zero(solver.unheld())}});
    if (!answer.recovery.unresisted.empty())
      warn({{"unresisted",
             set_to_zero(
               tfeti::describe(tfeti::plainest(answer.recovery.unresisted), solver.dual().body_motions().names()))}});
    const auto geometry = geometry_findings(scene,
                                            interface::penetrations(scene, solver.mesh(), solver.spaces(), u, t),
                                            contact.checks.max_displacement);
    warn(geometry.warnings);
    if (geometry.failure)
      log.warning(*geometry.failure);
    return !geometry.failure;
  }

  template <int dim>
  void Run<dim>::write_fields(const unsigned int step, const StepSolution &answer) const
  {
    if (!scene.output.vtu)
      return;
    output::write_fields(directory, solver.mesh(), solver.spaces(), answer.recovery.u, *answer.stress, step);
    output::write_pvd(directory, {scene.load_factors.begin(), scene.load_factors.begin() + step + 1});
  }

  template <int dim>
  void Run<dim>::estimate_errors(const double t, output::Summary &summary)
  {
    clock.enter("recovery");
    const auto nodes   = contact_steps.empty() ? std::vector<contact::ContactNode>() : contact_steps.back().nodes;
    errors             = goal_errors(solver, probes, *last, t, pressure_peaks(nodes, scene.contacts, comm), *wanted);
    summary.error_bars = error_bars(errors, summary.results, nodes, scene.contacts);
    clock.leave();
  }

  template <int dim>
  void Run<dim>::write(const output::Summary &summary) const
  {
    const HeldInterruption all_or_none;
    directory.write_together([&](const output::OutputDirectory &to) {
      output::write_history(to, summary.steps, dim);
      output::write_probes(to, summary.steps, dim);
      output::write_convergence(to, solver.convergence());
      to.write_from_root("parameters.prm", [&](std::ostream &out) { out << scene.parameters; });
      if (scene.has_contact())
        output::write_contact_csv(to, contact_names(scene), contact_steps);
      output::write_summary(to, summary);
    });
  }

  template <int dim>
  void Run<dim>::describe_run(output::Summary &summary) const
  {
    summary.time_s    = times(clock, solver.factorization_seconds());
    summary.memory_mb = memory(comm);
    summary.warnings  = warnings;
  }

  template class Run<2>;
  template class Run<3>;
} // namespace slipstick::app
