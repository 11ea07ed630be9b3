#include <slipstick/app/answer_warnings.h>
#include <slipstick/app/geometry_checks.h>
#include <slipstick/app/held_nodes.h>
#include <slipstick/app/interruption.h>
#include <slipstick/app/report.h>
#include <slipstick/app/simulation.h>
#include <slipstick/app/step_solver.h>
#include <slipstick/contact/resultants.h>
#include <slipstick/fem/arc_length.h>
#include <slipstick/fem/loads.h>
#include <slipstick/output/conditions.h>
#include <slipstick/output/contact_line.h>
#include <slipstick/output/fields.h>
#include <slipstick/output/history.h>

#include <deal.II/base/mpi.h>

#include <boost/serialization/array.hpp>
#include <boost/serialization/vector.hpp>

#include <optional>
#include <set>

namespace slipstick::app
{
  namespace
  {
    constexpr int dim = 2;

    // Tables are written again after this multiple of the time that writing them took.
    constexpr double pause_over_writing = 10;

    /// Contact nodes of all ranks on rank 0, with their arc lengths.
    output::ContactStep gather_contact(const scene::Scene<dim>       &scene,
                                       const fem::Mesh<dim>          &mesh,
                                       const fem::Spaces<dim>        &spaces,
                                       const contact::CheckedContact &own)
    {
      const auto          lengths = fem::arc_lengths(scene, mesh, spaces);
      const auto          nodes   = dealii::Utilities::MPI::gather(mesh.comm, own.nodes);
      const auto          keys    = dealii::Utilities::MPI::gather(mesh.comm, own.keys);
      output::ContactStep step;
      for (unsigned int rank = 0; rank < nodes.size(); ++rank)
        for (unsigned int i = 0; i < nodes[rank].size(); ++i)
          {
            auto node       = nodes[rank][i];
            node.arc_length = lengths.at({node.pair, keys[rank][i]});
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
        , warnings(warnings_before(scene, solver.mesh()))
      {}

      ExitStatus solve_and_write()
      {
        solver.build();
        directory.remove_results(); // the scene is accepted: results of an earlier run are no longer valid
        output::write_conditions(directory, scene, solver.mesh(), solver.spaces());
        output::Summary summary;
        for (unsigned int step = 0; step < scene.load_factors.size(); ++step)
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
            (kept_steps > 0 ? format("summary.json, history.csv and contact.csv in %s hold the results of the first %u",
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
        output::write_summary(directory, summary);
        kept_steps   = step + 1;
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
          log.line(format("load step    %u of %zu, t = %g", step + 1, scene.load_factors.size(), t));
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

        if (!answer->recovery.unresisted.empty())
          warn({{"unresisted",
                 format("nothing resists %s, and no load acts along it: it is set to zero; add a support or a contact "
                        "against this motion if it matters",
                        tfeti::describe(tfeti::plainest(answer->recovery.unresisted), solver.dual().body_names())
                          .c_str())}});
        const auto geometry =
          judge(scene, fem::penetrations(scene, solver.mesh(), solver.spaces(), u, t), contact.checks.max_displacement);
        warn(geometry.warnings);
        if (geometry.failure)
          log.warning(*geometry.failure);

        clock.enter("output");
        auto summary =
          make_summary(scene, solver.mesh(), solver.spaces(), solver.dual(), solution, contact.checks, stress);
        if (geometry.failure)
          summary.status = output::RunStatus::not_converged;
        summary.results.forces = forces(*answer, t);
        if (scene.output.vtu)
          {
            output::write_fields(directory, solver.mesh(), solver.spaces(), u, stress, step);
            output::write_pvd(directory, {scene.load_factors.begin(), scene.load_factors.begin() + step + 1});
          }
        if (scene.has_contact())
          {
            contact_steps.push_back(gather_contact(scene, solver.mesh(), solver.spaces(), contact));
            contact_steps.back().step = step;
            output::write_contact_vtp(directory, contact_steps.back());
            summary.results.contact = contact::pair_results(contact_steps.back().nodes, contact_names().pairs);
          }
        clock.leave();
        add_step(so_far, t, summary);
        return summary;
      }

      /// Resultants of loads and supports; warns of loads whose formulas no mesh resolves.
      output::ForceSummary forces(const StepSolver::Answer &answer, const double t)
      {
        output::ForceSummary sums;
        const auto           loads = fem::load_resultants(scene, solver.mesh(), solver.spaces(), t);
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
        for (unsigned int h = 0; h < n_supports; ++h)
          sums.supports.push_back({scene.supports[h].name, "support", reactions[h]});
        for (unsigned int h = n_supports; h < n_holders; ++h)
          sums.foundations.push_back({scene.foundations[h - n_supports].name, "foundation", reactions[h]});
        return sums;
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
      std::vector<output::ContactStep> contact_steps;
      std::vector<std::string>         warnings;
      std::set<std::string>            warned_about;
      std::optional<output::Summary>   finished_steps;   // of all load steps that have ended
      unsigned int                     kept_steps   = 0; // in the tables on the disk
      double                           kept_at      = 0; // when they were written [s]
      double                           writing_time = 0; // that this took [s]
    };
  } // namespace

  void check_scene(const scene::Scene<dim> &scene, const Log &log, const MPI_Comm comm)
  {
    StageClock clock;
    StepSolver(scene, log, clock, comm).build();
    log.line(
      "the scene is complete: every subdomain has its rigid motions as kernel, every body is held by supports or contact");
  }

  ExitStatus run(const scene::Scene<dim> &scene,
                 const std::string       &output_directory,
                 const Log               &log,
                 const MPI_Comm           comm)
  {
    const output::OutputDirectory directory(output_directory, comm);
    std::optional<Run>            steps;
    try
      {
        steps.emplace(scene, directory, log, comm);
        return steps->solve_and_write();
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
