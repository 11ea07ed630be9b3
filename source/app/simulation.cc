#include <slipstick/app/doubts.h>
#include <slipstick/app/report.h>
#include <slipstick/app/simulation.h>
#include <slipstick/contact/refinement.h>
#include <slipstick/fem/arc_length.h>
#include <slipstick/fem/assembly.h>
#include <slipstick/fem/contact_constraints.h>
#include <slipstick/fem/contact_search.h>
#include <slipstick/fem/decomposition.h>
#include <slipstick/fem/loads.h>
#include <slipstick/fem/pair_checks.h>
#include <slipstick/output/contact_line.h>
#include <slipstick/output/convergence.h>
#include <slipstick/output/fields.h>

#include <deal.II/base/mpi.h>

#include <boost/serialization/array.hpp>
#include <boost/serialization/vector.hpp>

#include <cmath>
#include <limits>
#include <memory>
#include <optional>
#include <set>

namespace slipstick::app
{
  namespace
  {
    constexpr int    dim      = 2;
    constexpr double infinity = std::numeric_limits<double>::infinity();

    // Contact nodes get multipliers at first when their gap exceeds the smallest of the pair by less than this part of the
    // slave boundary's length ...
    constexpr double first_kept_part = 0.1;
    // ... more of them, by this factor, when others would penetrate ...
    constexpr double growth_of_kept_part = 4;
    // ... and all beyond this part.
    constexpr double largest_kept_part = 1;

    // A solution whose checks fail is taken further so often ...
    constexpr unsigned int max_tightenings = 4;
    // ... by the factor that the worst check is above its limit, and this one more, ...
    constexpr double margin_of_tightening = 2;
    // ... by no less ...
    constexpr double least_tightening = 2;
    // ... and no more at a time, ...
    constexpr double largest_tightening = 1e4;
    // ... down to what double precision reaches nearly everywhere.
    constexpr double least_tolerance = 1e-13;
    // Tolerance = auto: the algebraic error may be this part of the discretisation error. The two are orthogonal, nearly, so
    // that it adds 4.4 % to the total one at most, less as it is estimated from above.
    constexpr double allowed_part = 0.3;

    std::vector<std::string> names_of(const std::vector<scene::Body<dim>> &bodies)
    {
      std::vector<std::string> names;
      for (const auto &body : bodies)
        names.push_back(body.name);
      return names;
    }

    /// Observer of the solver: a line on the console and a row of convergence.csv.
    contact::ProgressObserver convergence_observer(const Log                           &log,
                                                   const scene::SolverOptions          &options,
                                                   const unsigned int                   step_number,
                                                   const std::uint64_t                  multiplications_before,
                                                   std::vector<output::ConvergenceRow> &rows)
    {
      log.line(
        format("solve        %s until %sprojected gradient gP and violation of G x = e are below %g |Pd|",
               name_of(options.algorithm).c_str(),
               options.stops_at_discretization_error
                 ? format("the algebraic error is below %g of the discretisation error, or ", allowed_part).c_str()
                 : "",
               options.tolerance));
      log.line("              step  F-multiplications  |gP|/|Pd|  |Gx|/|Pd|  at a bound  slip bounds");
      return [&log, &options, step_number, multiplications_before, &rows](const contact::Progress &progress) {
        const auto            &step = progress.step;
        output::ConvergenceRow row;
        row.step                    = step_number;
        row.algorithm               = name_of(options.algorithm);
        row.friction_step           = progress.friction_iteration;
        row.outer_step              = step.outer;
        row.hessian_multiplications = multiplications_before + step.hessian_multiplications;
        row.projected_gradient      = step.projected_gradient;
        row.equality                = step.equality_residual;
        row.at_lower_bound          = step.active_lower;
        row.at_upper_bound          = step.active_upper;
        rows.push_back(row);
        log.line(format("             %5u  %17u  %9.2e  %9.2e  %10zu  %11u",
                        step.outer,
                        step.hessian_multiplications,
                        step.projected_gradient,
                        step.equality_residual,
                        step.active_lower + step.active_upper,
                        progress.friction_iteration));
      };
    }

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

    /// What can be said of a run that ended without equilibrium.
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

    /// Appends the contact pairs that a search finds; bodies that overlap must have one.
    void add_found_contacts(scene::Scene<dim>      &scene,
                            const fem::Mesh<dim>   &mesh,
                            const fem::Spaces<dim> &spaces,
                            const Log              &log)
    {
      for (auto &pair : fem::find_contacts(scene, mesh, spaces))
        {
          log.line("contact      found between " + pair.name);
          scene.contacts.push_back(std::move(pair));
        }
      fem::check_overlap(scene, mesh, spaces);
      fem::check_obstacle_pairs(scene, mesh, spaces);
    }

    /// Everything that the load steps share, and what they leave behind.
    class Run
    {
    public:
      Run(const scene::Scene<dim>       &scene_,
          const output::OutputDirectory &directory_,
          const Log                     &log_,
          const MPI_Comm                 comm_)
        : scene(scene_)
        , directory(directory_)
        , log(log_)
        , comm(comm_)
        , options(contact::resolved_options(scene_))
      {
        // what applies K+ more often than the one recovery
        options.dual.keeps_factors = scene.load_factors.size() > 1 || options.stops_at_discretization_error ||
                                     options.dual.operator_precision == tfeti::Precision::single_precision;
      }

      ExitStatus solve_and_write()
      {
        build_mesh();
        build_dual(scene.load_factors.front());
        contact::SlipLaw(scene, *dual, scene.load_factors.front()); // refuses bounds before anything is removed
        directory.remove_results(); // the scene is accepted: what an earlier run left is no longer true
        output::Summary summary;
        for (unsigned int step = 0; step < scene.load_factors.size(); ++step)
          {
            summary = load_step(step, summary);
            if (summary.status != output::RunStatus::converged)
              break;
          }
        clock.enter("output");
        write_tables();
        clock.leave();
        summary.time_s    = times(clock, factorization);
        summary.memory_mb = memory(comm);
        summary.warnings  = warnings;
        output::write_summary(directory, summary);
        print_result(log, summary, directory.path(scene.output.vtu ? "solution.pvd" : "summary.json"));
        return summary.status == output::RunStatus::converged ? ExitStatus::converged : ExitStatus::not_converged;
      }

    private:
      /// A recovered displacement, and what was found from it.
      struct Answer
      {
        tfeti::DualProblem::Recovery           recovery;
        std::optional<contact::CheckedContact> contact;
        std::optional<fem::StressResult>       stress;
      };

      void build_mesh()
      {
        print_header(log, scene, comm);
        clock.enter("mesh");
        mesh   = std::make_unique<fem::Mesh<dim>>(fem::make_mesh(scene, comm));
        spaces = std::make_unique<fem::Spaces<dim>>(*mesh, scene.discretization.degree);
        print_mesh(log, scene, *mesh, *spaces);
        warnings = warnings_before(scene, *mesh);
        add_found_contacts(scene, *mesh, *spaces, log);
      }

      /// What is doubtful about the answer, once a kind and pair.
      void warn(const std::vector<contact::ContactNode> &nodes)
      {
        for (const auto &[about, text] : doubts(scene, *mesh, *spaces, dual->constraints(), nodes, u))
          if (warned_about.insert(about).second)
            {
              log.line("             warning: " + text);
              warnings.push_back(text);
            }
      }

      /// K_p, B, F at load factor t, without the rows of pruned contact nodes unless a body is held by them.
      void build_dual(const double t)
      {
        if (options.prune_contact && kept_part < infinity)
          try
            {
              make_dual(t);
              return;
            }
          catch (const NoEquilibrium &) // on all ranks alike
            {
              if (pruned.rows->size() == 0)
                throw;
              kept_part = infinity;
            }
        kept_part = infinity;
        make_dual(t);
      }

      void make_dual(const double t)
      {
        clock.enter("assembly");
        auto matrices = fem::assemble(scene, *mesh, *spaces, t);
        auto rows     = fem::contact_rows(scene, *mesh, *spaces, t, kept_part);
        pruned        = std::move(rows.pruned);
        print_constraints(log, rows.active);

        clock.enter("dual setup");
        dual.reset();
        dual = std::make_unique<tfeti::DualProblem>(std::move(matrices),
                                                    std::move(rows.active),
                                                    options.dual,
                                                    names_of(scene.bodies),
                                                    comm);
        factorization += dual->factorization_seconds();
        print_dual(log, *dual);
      }

      /// Loads and right-hand sides of a later step; slip starts from where the step before ended.
      /// @return whether the multipliers of the step before fit the rows.
      bool advance(const double t)
      {
        clock.enter("assembly");
        std::vector<Eigen::VectorXd> loads = fem::assemble_loads(scene, *mesh, *spaces, t);
        auto                         rows  = fem::contact_rows(scene, *mesh, *spaces, t, kept_part);
        const bool                   is_same =
          dealii::Utilities::MPI::min(rows.active.label == dual->constraints().label ? 1 : 0, comm) > 0;
        if (is_same) // gaps that follow the load factor may prune other nodes
          {
            pruned = std::move(rows.pruned);
            clock.enter("dual setup");
            dual->set_step(std::move(loads), std::move(rows.active.c));
          }
        else
          make_dual(t);
        start_slip_from_here();
        return is_same;
      }

      /// Slip counts from the displacement at the end of the step before.
      void start_slip_from_here()
      {
        auto       c     = dual->constraints().c;
        const auto jumps = dual->jumps(u);
        for (unsigned int r = 0; r < c.size(); ++r)
          if (dual->constraints().kind[r] == tfeti::RowKind::tangential)
            c[r] = jumps.local_element(r);
        dual->set_right_hand_side(std::move(c));
      }

      /// Checks and stresses of what was recovered from @p from.
      void look_at(Answer &answer, const contact::DualSolution &from, const double t) const
      {
        const contact::SlipLaw law(scene, *dual, t);
        const auto            &x = answer.recovery.multipliers;
        const auto            &u = answer.recovery.u;
        answer.contact           = contact::check(*dual,
                                        x,
                                        u,
                                        law.depends_on_pressure() ? law.bounds(x) : from.slip_bound,
                                        from.free,
                                        scene.bodies.size());
        answer.stress            = fem::recover_stress(scene, *mesh, *spaces, dual->constraints(), u, t);
      }

      /// Is the algebraic error of an iterate a small part of its discretisation error, and does it pass the checks? A step
      /// looks at its last estimate first, which errors of the iterates so far can only have made too large, and recovers
      /// a displacement only when that does not decide.
      bool is_accurate(const contact::DualSolution &iterate, const double residual_energy, const double t)
      {
        if (residual_energy > allowed_part * discretization_error)
          return false;
        try
          {
            Answer answer;
            answer.recovery = dual->recover(iterate.multipliers, iterate.free);
            look_at(answer, iterate, t);
            const auto &checks           = answer.contact->checks;
            discretization_error         = std::sqrt(answer.stress->error_squared);
            const double algebraic_error = std::sqrt(checks.error_energy);
            log.line(format("accuracy     algebraic error below %.3g, discretisation error about %.3g sqrt(N mm)",
                            algebraic_error,
                            discretization_error));
            if (algebraic_error > allowed_part * discretization_error || !(checks.worst().second <= check_limit(1)))
              return false;
            accepted = std::make_unique<Answer>(std::move(answer));
            return true;
          }
        catch (const NoEquilibrium &) // of this iterate, on all ranks alike
          {
            return false;
          }
      }

      /// Solves the present step; with rows for more contact nodes as long as pruned ones penetrate.
      /// @param goes_on from the solution of this step.
      std::unique_ptr<Answer> solve_step(const unsigned int  step,
                                         const std::uint64_t multiplications_before,
                                         const bool          goes_on)
      {
        const double t         = scene.load_factors[step];
        bool         is_warm   = goes_on || (step > 0 && advance(t));
        qp::Counts   discarded = goes_on ? solution.counts : qp::Counts();
        discretization_error   = infinity;
        contact::AccuracyTest test;
        if (options.stops_at_discretization_error && !goes_on)
          test = [this, t](const contact::DualSolution &iterate, const double residual_energy) {
            return is_accurate(iterate, residual_energy, t);
          };
        for (;; is_warm = false)
          {
            std::string reason;
            try
              {
                clock.enter("solve");
                accepted.reset();
                solution = contact::solve_refined(*dual,
                                                  contact::SlipLaw(scene, *dual, t),
                                                  options,
                                                  scene.friction,
                                                  convergence_observer(log,
                                                                       options,
                                                                       step,
                                                                       multiplications_before +
                                                                         discarded.hessian_multiplications,
                                                                       convergence),
                                                  is_warm ? &solution : nullptr,
                                                  test);
                discarded += solution.counts;
                solution.counts = discarded;
                clock.enter("recovery");
                auto answer = std::move(accepted);
                if (!answer)
                  {
                    answer           = std::make_unique<Answer>();
                    answer->recovery = dual->recover(solution.multipliers, solution.free);
                  }
                const double penetration = fem::largest_penetration(pruned, answer->recovery.u, comm);
                if (!(penetration > 0))
                  return answer;
                reason = format("contact nodes without multipliers would penetrate by %.3g mm", penetration);
              }
            catch (const NoEquilibrium &) // on all ranks alike
              {
                if (pruned.rows->size() == 0)
                  throw;
                reason = "no equilibrium without the contact nodes that are far apart";
              }
            kept_part = kept_part < largest_kept_part ? growth_of_kept_part * kept_part : infinity;
            log.line("pruning      " + reason + ": solved again with more of them");
            make_dual(t);
            if (step > 0)
              start_slip_from_here();
          }
      }

      std::unique_ptr<Answer> checked(std::unique_ptr<Answer> answer, const double t) const
      {
        if (!answer->stress)
          look_at(*answer, solution, t);
        return answer;
      }

      /// Goes on from a solution whose checks fail, to smaller residuals: those that are asked for are relative to |Pd|,
      /// which may be far above what is left of it in the displacement (slender parts). Ends where that does not help.
      std::unique_ptr<Answer> tighten(const unsigned int      step,
                                      const std::uint64_t     multiplications_before,
                                      std::unique_ptr<Answer> answer)
      {
        const double limit = check_limit(tolerance_of(scene.solver, solution));
        for (unsigned int n = 0; n < max_tightenings && solution.status == qp::Status::converged; ++n)
          {
            const auto   worst = answer->contact->checks.worst_entry();
            const double reached =
              std::min(options.tolerance, std::max(solution.projected_gradient, solution.equality));
            if (worst.value <= limit || worst.is_balance || reached <= least_tolerance)
              break;
            // an answer that is no number, too
            const double excess = std::min(largest_tightening, std::max(least_tightening, worst.value / limit));
            options.tolerance   = std::max(reached / (margin_of_tightening * excess), least_tolerance);
            log.line(format("checks       %s is %.1e, allowed is %.1e: solved on to a tolerance of %.1e",
                            worst.name,
                            worst.value,
                            limit,
                            options.tolerance));
            const auto   before  = solution;
            const double kept    = kept_part;
            solution.multipliers = answer->recovery.multipliers;
            auto next            = checked(solve_step(step, multiplications_before, true), scene.load_factors[step]);
            if (kept_part != kept ||
                (solution.status == qp::Status::converged && next->contact->checks.worst().second < worst.value))
              answer = std::move(next); // the first: it got rows for more contact nodes
            else
              { // to the tolerance that was asked for it did converge
                const auto counts = solution.counts;
                solution          = before;
                solution.counts   = counts;
                break;
              }
          }
        return answer;
      }

      /// @param so_far of the steps before.
      output::Summary load_step(const unsigned int step, const output::Summary &so_far)
      {
        const double t = scene.load_factors[step];
        if (scene.load_factors.size() > 1)
          log.line(format("load step    %u of %zu, t = %g", step + 1, scene.load_factors.size(), t));
        options.tolerance      = scene.solver.tolerance;
        const auto answer      = tighten(step,
                                    so_far.solver.hessian_multiplications,
                                    checked(solve_step(step, so_far.solver.hessian_multiplications, false), t));
        u                      = std::move(answer->recovery.u);
        solution.multipliers   = std::move(answer->recovery.multipliers);
        const auto  &contact   = *answer->contact;
        const auto  &stress    = *answer->stress;
        const double tolerance = tolerance_of(scene.solver, solution);
        print_checks(log, contact.checks, tolerance);
        if (!passes(solution, contact.checks, tolerance))
          print_failure(log, scene, solution, contact.checks, tolerance);
        warn(contact.nodes);

        clock.enter("output");
        auto summary = make_summary(scene, *mesh, *spaces, *dual, solution, contact.checks, stress);
        if (scene.output.vtu)
          {
            output::write_fields(directory, *mesh, *spaces, u, stress, step);
            output::write_pvd(directory, {scene.load_factors.begin(), scene.load_factors.begin() + step + 1});
          }
        if (scene.has_contact())
          {
            contact_steps.push_back(gather_contact(scene, *mesh, *spaces, contact));
            contact_steps.back().step = step;
            output::write_contact_vtp(directory, contact_steps.back());
            summary.results.contact = contact::pair_results(contact_steps.back().nodes, contact_names().pairs);
          }
        clock.leave();
        add_step(so_far, t, summary);
        return summary;
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

      void write_tables() const
      {
        output::write_convergence(directory, convergence);
        directory.write_from_root("parameters.prm", [&](std::ostream &out) { out << scene.parameters; });
        if (scene.has_contact())
          output::write_contact_csv(directory, contact_names(), contact_steps);
      }

      scene::Scene<dim>              scene; // with the contact pairs that are found
      const output::OutputDirectory &directory;
      const Log                     &log;
      const MPI_Comm                 comm;
      scene::SolverOptions           options;
      StageClock                     clock;

      std::unique_ptr<fem::Mesh<dim>>     mesh;
      std::unique_ptr<fem::Spaces<dim>>   spaces;
      std::unique_ptr<tfeti::DualProblem> dual;
      tfeti::Constraints                  pruned; // normal rows of the contact nodes without multipliers
      double                              kept_part            = first_kept_part;
      double                              factorization        = 0;        // [s]
      double                              discretization_error = infinity; // last estimate in the step [sqrt(N mm)]
      contact::DualSolution               solution;                        // of the last step
      std::unique_ptr<Answer>             accepted;                        // by the test of accuracy, in the step
      std::vector<Eigen::VectorXd>        u;                               // of the last step
      std::vector<output::ConvergenceRow> convergence;
      std::vector<output::ContactStep>    contact_steps;
      std::vector<std::string>            warnings;
      std::set<std::string>               warned_about;
    };
  } // namespace

  void check_scene(scene::Scene<dim> scene, const Log &log, const MPI_Comm comm)
  {
    print_header(log, scene, comm);
    const auto             mesh = fem::make_mesh(scene, comm);
    const fem::Spaces<dim> spaces(mesh, scene.discretization.degree);
    print_mesh(log, scene, mesh, spaces);
    add_found_contacts(scene, mesh, spaces, log);
    const double t           = scene.load_factors.front();
    auto         constraints = fem::contact_constraints(scene, mesh, spaces, t);
    print_constraints(log, constraints);
    const tfeti::DualProblem dual(fem::assemble(scene, mesh, spaces, t),
                                  std::move(constraints),
                                  contact::resolved_options(scene).dual,
                                  names_of(scene.bodies),
                                  comm);
    print_dual(log, dual);
    contact::SlipLaw(scene, dual, t);
    log.line(
      "the scene is complete: every subdomain has its rigid motions as kernel, every body is held by supports or contact");
  }

  ExitStatus run(const scene::Scene<dim> &scene,
                 const std::string       &output_directory,
                 const Log               &log,
                 const MPI_Comm           comm)
  {
    const output::OutputDirectory directory(output_directory, comm);
    try
      {
        return Run(scene, directory, log, comm).solve_and_write();
      }
    catch (const InputError &) // some of it shows in meshes and formulas only
      {
        directory.remove_if_new();
        throw;
      }
    catch (const NoEquilibrium &) // on all ranks alike
      {
        directory.remove_results();
        output::write_summary(directory, summary_without_equilibrium(scene, comm));
        throw;
      }
  }
} // namespace slipstick::app
