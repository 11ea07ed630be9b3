#include <slipstick/app/held_nodes.h>
#include <slipstick/app/names.h>
#include <slipstick/app/run_summary.h>
#include <slipstick/app/step_solver.h>
#include <slipstick/base/collective.h>
#include <slipstick/base/exceptions.h>
#include <slipstick/contact/refinement.h>

#include <deal.II/base/mpi.h>

#include <cmath>
#include <limits>

namespace slipstick::app
{
  namespace
  {
    constexpr double infinity = std::numeric_limits<double>::infinity();

    // A solution whose checks fail is continued at most this number of times ...
    constexpr unsigned int max_tightenings = 4;
    // ... with a tolerance reduced by the ratio of the worst check to its limit, times this factor, ...
    constexpr double margin_of_tightening = 2;
    // ... at least by this factor ...
    constexpr double least_tightening = 2;
    // ... but at most by this factor at a time, ...
    constexpr double largest_tightening = 1e4;
    // ... even if the check does not decrease, if errors are as large as this fraction of the solution: they cannot
    // grow much ...
    constexpr double of_no_answer = 0.5;
    // ... down to what double precision nearly always achieves.
    constexpr double least_tolerance = 1e-13;
    // Below this tolerance rounding of the multipliers may matter; gaps are then first closed in the displacement ...
    constexpr double tolerance_of_rounding = 1e-10;
    // ... at most this number of times, as long as the worst check decreases by this factor.
    constexpr unsigned int max_closings     = 4;
    constexpr double       closing_progress = 0.5;
    // Tolerance = auto: admissible ratio of algebraic to discretisation error. The two are nearly orthogonal, so that
    // the algebraic error adds 2 % to the total error, 5 % if both estimates are wrong by a quarter.
    constexpr double allowed_part = 0.2;
    // Admissible estimated error of the tractions of a pair, beside Solver/Tolerance; Tolerance = auto ends there.
    constexpr double allowed_traction_error = 0.05;

    template <int dim>
    scene::SolverOptions resolved_options(const scene::Scene<dim> &scene, const bool solves_adjoints)
    {
      auto options = contact::resolved_options(scene);
      // these cases apply K+ more often than a single recovery does
      options.dual.keeps_factors = solves_adjoints || scene.load_factors.size() > 1 ||
                                   options.stops_at_discretization_error ||
                                   options.dual.operator_precision == tfeti::Precision::single_precision;
      return options;
    }

    std::vector<double> values_of(const tfeti::DistributedVector &x)
    {
      std::vector<double> values(x.locally_owned_size());
      for (std::size_t r = 0; r < values.size(); ++r)
        values[r] = x.local_element(r);
      return values;
    }

    tfeti::DistributedVector vector_of(const std::vector<double> &values, const tfeti::DualProblem &dual)
    {
      auto x = dual.zero();
      for (std::size_t r = 0; r < values.size(); ++r)
        x.local_element(r) = values[r];
      return x;
    }

    /// Observer of the solver: prints a line and adds a row to convergence.csv.
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
  } // namespace

  template <int dim>
  StepSolver<dim>::StepSolver(const scene::Scene<dim> &scene_,
                              const Log               &log_,
                              StageClock              &clock_,
                              const MPI_Comm           comm_,
                              const bool               solves_adjoints,
                              mesh::Refinement        *refinement)
    : log(log_)
    , clock(clock_)
    , comm(comm_)
    , options(resolved_options(scene_, solves_adjoints))
    , problem(scene_, log, clock, comm, options, refinement)
    , discretization_error(infinity)
  {}

  template <int dim>
  void StepSolver<dim>::build()
  {
    const double t = discrete_scene().load_factors.front();
    problem.build(t);
    contact::SlipLaw(discrete_scene(), dual(), t); // throws for invalid bounds
  }

  template <int dim>
  void StepSolver<dim>::start_from(contact::ContactOfMesh other)
  {
    other_mesh = std::move(other);
  }

  template <int dim>
  StepState StepSolver<dim>::state() const
  {
    StepState state;
    state.kept_part    = problem.kept_part();
    state.largest_load = problem.largest_load();
    state.built_at     = problem.built_at();
    state.history      = history;
    state.rows         = rows;
    state.labels       = dual().constraints().label;
    state.multipliers  = values_of(dual_solution.multipliers);
    state.has_gradient = dual_solution.gradient.has_value();
    if (state.has_gradient)
      state.gradient = values_of(*dual_solution.gradient);
    state.reference          = dual_solution.reference;
    state.weighted_reference = dual_solution.weighted_reference;
    state.largest_forces     = dual_solution.largest_forces;
    state.largest_traction   = dual_solution.largest_traction;
    state.bolts              = tightening().state();
    for (const auto &part : u)
      state.u.emplace_back(part.data(), part.data() + part.size());
    if (dual_solution.directions)
      for (std::size_t j = 0; j < dual_solution.directions->size(); ++j)
        {
          const auto &direction = (*dual_solution.directions)[j];
          state.directions.push_back({values_of(direction.p), values_of(direction.Fp), direction.error});
        }
    return state;
  }

  template <int dim>
  void StepSolver<dim>::resume(const StepState &state)
  {
    history = state.history;
    rows    = state.rows;
    problem.restore(state.kept_part, state.largest_load);
    problem.build(state.built_at);
    collectively(comm, [&] {
      bool fits = state.labels == dual().constraints().label && state.u.size() == dual().subdomains().size();
      for (std::size_t p = 0; fits && p < state.u.size(); ++p)
        fits = state.u[p].size() == dual().subdomains()[p]->n_unknowns();
      if (!fits)
        throw InputError("--resume: meshes or contact differ from those of the run to be continued",
                         "omit --resume to start from the first load step");
    });
    for (const auto &part : state.u)
      u.push_back(Eigen::Map<const Eigen::VectorXd>(part.data(), part.size()));
    dual_solution.multipliers = vector_of(state.multipliers, dual());
    if (state.has_gradient)
      dual_solution.gradient = vector_of(state.gradient, dual());
    dual_solution.reference          = state.reference;
    dual_solution.weighted_reference = state.weighted_reference;
    dual_solution.largest_forces     = state.largest_forces;
    dual_solution.largest_traction   = state.largest_traction;
    problem.tightening().restore(state.bolts);
    if (state.directions.empty())
      return;
    dual_solution.directions =
      std::make_shared<qp::DirectionStore<tfeti::DistributedVector>>(options.newton.n_directions);
    for (const auto &[p, Fp, error] : state.directions)
      dual_solution.directions->push(vector_of(p, dual()),
                                     vector_of(Fp, dual()),
                                     error,
                                     qp::dependent_compliances(dual(), 0),
                                     dual().reduction());
  }

  template <int dim>
  std::unique_ptr<StepSolution> StepSolver<dim>::solve(const unsigned int  step,
                                                       const std::uint64_t multiplications_before)
  {
    const double t    = discrete_scene().load_factors[step];
    options.tolerance = discrete_scene().solver.tolerance;
    if (problem.bolts())
      {
        problem.begin_bolts(t);
        if (step == 0)
          problem.reload(t);
      }
    auto answer = continue_to_smaller_residual(step,
                                               multiplications_before,
                                               checked(solve_step(step, multiplications_before, false), t));
    if (problem.bolts())
      answer = tighten_bolts(step, multiplications_before, std::move(answer));
    answer = balance_still_motions(step, multiplications_before, std::move(answer));
    history.add(answer->contact->checks);
    dual_solution.multipliers = answer->recovery.multipliers;
    if (step + 1 < discrete_scene().load_factors.size())
      keep_for_next_step(answer->recovery, t);
    return answer;
  }

  template <int dim>
  std::unique_ptr<StepSolution> StepSolver<dim>::balance_still_motions(const unsigned int  step,
                                                                       const std::uint64_t multiplications_before,
                                                                       std::unique_ptr<StepSolution> answer)
  {
    constexpr unsigned int most_repetitions = 3; // each leaves the part that the forces change by: about gap over size
    const double           t                = discrete_scene().load_factors[step];
    for (unsigned int n = 0; n < most_repetitions && dual_solution.status == qp::Status::converged &&
                             problem.spread_still_forces(answer->recovery.multipliers, dual_solution.largest_forces);
         ++n)
      {
        problem.reload(t);
        options.tolerance         = discrete_scene().solver.tolerance;
        dual_solution.multipliers = answer->recovery.multipliers;
        answer                    = continue_to_smaller_residual(step,
                                              multiplications_before,
                                              checked(solve_step(step, multiplications_before, true), t));
      }
    return answer;
  }

  template <int dim>
  void StepSolver<dim>::keep_for_next_step(const tfeti::Recovery &recovery, const double t)
  {
    const auto &contacts = discrete_scene().contacts;
    const bool  slips    = std::any_of(contacts.begin(), contacts.end(), [](const scene::ContactPair<dim> &pair) {
      return pair.law.has_tangential_row();
    });
    auto        exact    = recovery;
    if (slips && dual_solution.status == qp::Status::converged && dual_solution.directions)
      dual_solution.counts += contact::close_gaps(problem.dual(),
                                                  contact::SlipLaw(discrete_scene(), dual(), t),
                                                  dual_solution.free,
                                                  options.pcpg,
                                                  exact,
                                                  dual_solution.directions.get());
    u                         = std::move(exact.u);
    dual_solution.multipliers = std::move(exact.multipliers);
  }

  template <int dim>
  void StepSolver<dim>::evaluate(StepSolution &answer, const contact::DualSolution &from, const double t) const
  {
    const auto            &scene = discrete_scene();
    const contact::SlipLaw law(scene, dual(), t);
    const auto            &x = answer.recovery.multipliers;
    const auto            &u = answer.recovery.u;
    answer.contact =
      contact::check(dual(),
                     law,
                     x,
                     u,
                     law.depends_on_pressure() ? law.bounds(x) : from.slip_bound,
                     from.free,
                     scene.bodies.size(),
                     history,
                     problem.bolts()
                       ? problem.bolts()->initial_strain_energies(u, tightening().shortening(), scene.bodies.size())
                       : std::vector<double>());
    add_held_nodes(scene, dual(), held_contacts(), x, u, *answer.contact);
    answer.stress = mechanics::recover_stress(scene, mesh(), spaces(), dual().constraints(), elastic_part(u), t);
  }

  template <int dim>
  bool StepSolver<dim>::is_accurate(const contact::DualSolution &iterate, const double residual_energy, const double t)
  {
    if (residual_energy > allowed_part * discretization_error)
      return false;
    auto recovery = tfeti::recover_if_held(dual(), iterate.multipliers, iterate.free);
    if (!recovery)
      return false;
    StepSolution answer;
    answer.recovery = *std::move(recovery);
    evaluate(answer, iterate, t);
    const auto &checks           = answer.contact->checks;
    discretization_error         = std::sqrt(answer.stress->error_squared);
    const double algebraic_error = std::sqrt(checks.error_energy), of_tractions = checks.largest_traction_error();
    log.line(format(
      "accuracy     algebraic error below %.3g, discretisation error about %.3g sqrt(N mm); tractions to %.2g %%",
      algebraic_error,
      discretization_error,
      100 * of_tractions));
    if (algebraic_error > allowed_part * discretization_error || !(of_tractions <= allowed_traction_error) ||
        !(checks.worst().second <= check_limit(1)))
      return false;
    accepted = std::make_unique<StepSolution>(std::move(answer));
    return true;
  }

  template <int dim>
  std::unique_ptr<StepSolution> StepSolver<dim>::solve_step(const unsigned int  step,
                                                            const std::uint64_t multiplications_before,
                                                            const bool          continues)
  {
    const double t               = discrete_scene().load_factors[step];
    bool         is_warm         = continues || (step > 0 && advance(t));
    bool         is_carried_over = false;
    if (step == 0 && !continues && !other_mesh.nodes.empty())
      if (auto start = contact::start_from(other_mesh, dual(), contact_names(discrete_scene()).pairs))
        {
          dual_solution   = *std::move(start);
          is_carried_over = is_warm = true;
        }
    qp::Counts discarded = continues ? dual_solution.counts : qp::Counts();
    discretization_error = infinity;
    contact::AccuracyTest test;
    if (options.stops_at_discretization_error && !continues)
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
            const contact::SlipLaw law(discrete_scene(), dual(), t);
            dual_solution =
              contact::solve_refined(problem.dual(),
                                     law,
                                     options,
                                     discrete_scene().friction,
                                     convergence_observer(log,
                                                          options,
                                                          step,
                                                          multiplications_before + discarded.hessian_multiplications,
                                                          rows),
                                     is_warm ? &dual_solution : nullptr,
                                     test);
            discarded += dual_solution.counts;
            dual_solution.counts = discarded;
            if (is_carried_over && is_warm && dual_solution.status != qp::Status::converged)
              {
                log.line(
                  "solve        the contact state of the previous mesh is not a usable starting point: restarting from zero");
                continue;
              }
            clock.enter("recovery");
            auto answer = std::move(accepted);
            if (!answer)
              {
                answer           = std::make_unique<StepSolution>();
                answer->recovery = recovered(law.depends_on_pressure());
              }
            take_out_still_motions(*answer, t);
            const double penetration = problem.penetration_of_pruned(answer->recovery.u);
            if (!(penetration > 0))
              return answer;
            reason = format("contact nodes without multipliers would penetrate by %.3g mm", penetration);
          }
        catch (const NoEquilibrium &) // on all ranks
          {
            if (!problem.is_pruned())
              throw;
            reason = "no equilibrium without the contact nodes that are far apart";
          }
        log.line("pruning      " + reason + ": solving again with more of them");
        problem.keep_more(t);
        if (step > 0)
          problem.start_slip_from(u);
      }
  }

  template <int dim>
  bool StepSolver<dim>::advance(const double t)
  {
    using Rows      = typename StepProblem<dim>::Rows;
    const Rows rows = problem.advance(t, u);
    if (rows == Rows::moved) // products with F are those of other rows
      {
        dual_solution.multipliers = vector_of(values_of(dual_solution.multipliers), dual());
        dual_solution.gradient.reset();
        dual_solution.directions.reset();
      }
    return rows != Rows::others;
  }

  // Motions that additional supports hold at a node: there, deformation would show as a motion. Motions that only open
  // contact leaves are taken out together with them, since a rotation about that node is not one about the centroid.
  template <int dim>
  void StepSolver<dim>::take_out_still_motions(StepSolution &answer, const double t)
  {
    constexpr double part_of_limit = 0.01;
    if (problem.still_motions().empty())
      return;
    double size = 0;
    for (const auto &part : answer.recovery.u)
      size = std::max(size, part.size() > 0 ? part.lpNorm<Eigen::Infinity>() : 0.);
    const double limit     = check_limit(tolerance_of(discrete_scene().solver, dual_solution));
    const double tolerated = part_of_limit * limit * dealii::Utilities::MPI::max(size, comm);
    const auto   take_out  = [&](const std::vector<tfeti::RigidMotion> &motions) {
      return tfeti::remove_motions(problem.dual(), motions, dual_solution.free, tolerated, answer.recovery.u);
    };
    std::vector<tfeti::RigidMotion> all = problem.still_motions();
    all.insert(all.end(), answer.recovery.unresisted.begin(), answer.recovery.unresisted.end());
    if (!take_out(all) && all.size() > problem.still_motions().size())
      take_out(problem.still_motions());
    if (answer.stress)
      evaluate(answer, dual_solution, t);
  }

  // If the solution has not converged, work of the loads along a free motion does not prove that there is no
  // equilibrium; all rows then count as closed. The same holds for bounds that follow the pressure: forces that balance
  // the loads were found before the solve; only the set of rows inside their bounds is wrong.
  template <int dim>
  tfeti::Recovery StepSolver<dim>::recovered(const bool bounds_follow)
  {
    const bool  is_proof = problem.is_pruned() || (dual_solution.status == qp::Status::converged && !bounds_follow);
    const auto &x        = dual_solution.multipliers;
    const auto &free     = dual_solution.free;
    if (is_proof)
      return tfeti::recover(dual(), x, free, true); // unresisted motions without loads are set to zero
    if (auto recovery = tfeti::recover_if_held(dual(), x, free))
      return *std::move(recovery);
    if (dual_solution.status == qp::Status::converged)
      dual_solution.status = qp::Status::stagnated;
    return tfeti::recover(dual(), x, std::vector<bool>(free.size(), true));
  }

  template <int dim>
  std::unique_ptr<StepSolution> StepSolver<dim>::checked(std::unique_ptr<StepSolution> answer, const double t) const
  {
    if (!answer->stress)
      evaluate(*answer, dual_solution, t);
    return answer;
  }

  template <int dim>
  std::unique_ptr<StepSolution> StepSolver<dim>::continue_to_smaller_residual(
    const unsigned int            step,
    const std::uint64_t           multiplications_before,
    std::unique_ptr<StepSolution> answer)
  {
    const double limit = check_limit(tolerance_of(discrete_scene().solver, dual_solution));
    for (unsigned int n = 0; n < max_tightenings && dual_solution.status == qp::Status::converged; ++n)
      {
        const auto   worst     = answer->contact->checks.worst_entry();
        const bool   is_sound  = worst.value <= limit;
        const double tractions = answer->contact->checks.largest_traction_error();
        const double reached =
          std::min(options.tolerance, std::max(dual_solution.projected_gradient, dual_solution.equality));
        if (is_sound ? !(tractions > allowed_traction_error) : worst.is_balance)
          break;
        // also if the check is NaN
        const double excess =
          std::min(largest_tightening,
                   std::max({least_tightening, worst.value / limit, tractions / allowed_traction_error}));
        options.tolerance = std::max(reached / (margin_of_tightening * excess), least_tolerance);
        if (!is_sound && options.tolerance < tolerance_of_rounding && close_gaps(*answer, step, limit))
          break;
        if (reached <= least_tolerance)
          break;
        log.line(format("checks       %s is %.1e, allowed is %.1e: continuing with a tolerance of %.1e",
                        is_sound ? "error of pressures or tangential tractions" : worst.name,
                        is_sound ? tractions : worst.value,
                        is_sound ? allowed_traction_error : limit,
                        options.tolerance));
        const auto   before       = dual_solution;
        const double kept         = problem.kept_part();
        dual_solution.multipliers = answer->recovery.multipliers;
        auto        next = checked(solve_step(step, multiplications_before, true), discrete_scene().load_factors[step]);
        const auto &checks      = next->contact->checks;
        const bool  is_improved = is_sound
                                    ? checks.worst().second <= limit && checks.largest_traction_error() < tractions
                                    : worst.value > of_no_answer || checks.worst().second < worst.value;
        if (problem.kept_part() != kept || (dual_solution.status == qp::Status::converged && is_improved))
          answer = std::move(next); // the first solution has been solved again with rows for more contact nodes
        else
          { // it has converged to the requested tolerance
            const auto counts    = dual_solution.counts;
            dual_solution        = before;
            dual_solution.counts = counts;
            break;
          }
      }
    return answer;
  }

  template <int dim>
  bool StepSolver<dim>::close_gaps(StepSolution &answer, const unsigned int step, const double limit)
  {
    const contact::SlipLaw law(discrete_scene(), dual(), discrete_scene().load_factors[step]);
    double                 worst = answer.contact->checks.worst().second;
    for (unsigned int n = 0; n < max_closings && worst > limit; ++n)
      {
        StepSolution next;
        next.recovery = answer.recovery;
        dual_solution.counts +=
          contact::close_gaps(problem.dual(), law, dual_solution.free, options.pcpg, next.recovery);
        evaluate(next, dual_solution, discrete_scene().load_factors[step]);
        const double left = next.contact->checks.worst().second;
        log.line(
          format("checks       gaps closed by a correction of the displacement: largest %.1e, was %.1e", left, worst));
        const bool progresses = left < closing_progress * worst;
        if (left < worst)
          {
            answer = std::move(next);
            worst  = left;
          }
        if (!progresses)
          break;
      }
    return worst <= limit;
  }

  template class StepSolver<2>;
  template class StepSolver<3>;
} // namespace slipstick::app
