#include <slipstick/app/held_nodes.h>
#include <slipstick/app/names.h>
#include <slipstick/app/report.h>
#include <slipstick/app/step_solver.h>
#include <slipstick/base/collective.h>
#include <slipstick/base/exceptions.h>
#include <slipstick/contact/refinement.h>
#include <slipstick/interface/contact_search.h>
#include <slipstick/interface/pair_checks.h>
#include <slipstick/interface/shared_sides.h>
#include <slipstick/mechanics/assembly.h>
#include <slipstick/mechanics/loads.h>
#include <slipstick/mechanics/still_points.h>
#include <slipstick/mesh/decomposition.h>

#include <deal.II/base/mpi.h>

#include <cmath>
#include <limits>

namespace slipstick::app
{
  namespace
  {
    constexpr double infinity = std::numeric_limits<double>::infinity();

    // At first contact nodes get multipliers if their gap exceeds the smallest gap of the pair by less than this
    // fraction of the slave boundary's length ...
    constexpr double first_kept_part = 0.1;
    // ... more of them, by this factor, when others would penetrate ...
    constexpr double growth_of_kept_part = 4;
    // ... and all beyond this part.
    constexpr double largest_kept_part = 1;

    // A solution whose checks fail is continued at most this many times ...
    constexpr unsigned int max_tightenings = 4;
    // ... with a tolerance reduced by the factor by which the worst check exceeds its limit, times this one, ...
    constexpr double margin_of_tightening = 2;
    // ... by no less ...
    constexpr double least_tightening = 2;
    // ... but by no more than this at a time, ...
    constexpr double largest_tightening = 1e4;
    // ... even if the check does not decrease, where errors are as large as this fraction of the answer: they cannot
    // rise much ...
    constexpr double of_no_answer = 0.5;
    // ... down to what double precision achieves nearly everywhere.
    constexpr double least_tolerance = 1e-13;
    // Below this tolerance rounding of the multipliers may show; gaps are then closed in the displacement first ...
    constexpr double tolerance_of_rounding = 1e-10;
    // ... at most this many times, as long as the worst check falls by this factor.
    constexpr unsigned int max_closings     = 4;
    constexpr double       closing_progress = 0.5;
    // Tolerance = auto: the algebraic error may be this fraction of the discretisation error. The two are nearly
    // orthogonal, so that it adds at most 4.4 % to the total error, and less because it is estimated from above.
    constexpr double allowed_part = 0.3;

    template <int dim>
    std::vector<std::string> names_of(const std::vector<scene::Body<dim>> &bodies)
    {
      std::vector<std::string> names;
      for (const auto &body : bodies)
        names.push_back(body.name);
      return names;
    }

    std::string in_words(const std::vector<tfeti::RigidMotion> &motions, const std::vector<std::string> &body_names)
    {
      std::string text;
      for (const auto &motion : tfeti::disentangled(motions))
        text += (text.empty() ? "" : ", nor ") + tfeti::describe(motion, body_names);
      return text;
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
  } // namespace

  template <int dim>
  StepSolver<dim>::StepSolver(const scene::Scene<dim> &scene_,
                              const Log               &log_,
                              StageClock              &clock_,
                              const MPI_Comm           comm_,
                              const bool               solves_adjoints,
                              mesh::Refinement        *refinement)
    : scene(scene_)
    , log(log_)
    , clock(clock_)
    , comm(comm_)
    , options(contact::resolved_options(scene_))
    , n_given(scene_.supports.size())
    , kept_part(first_kept_part)
    , discretization_error(infinity)
  {
    // these apply K+ more often than a single recovery does
    options.dual.keeps_factors = solves_adjoints || scene.load_factors.size() > 1 ||
                                 options.stops_at_discretization_error ||
                                 options.dual.operator_precision == tfeti::Precision::single_precision;
    print_header(log, scene, comm);
    clock.enter("mesh");
    the_mesh   = std::make_unique<mesh::Mesh<dim>>(mesh::make_mesh(scene, comm, refinement));
    the_spaces = std::make_unique<mechanics::Spaces<dim>>(*the_mesh, scene.discretization.degree);
    print_mesh(log, scene, *the_mesh, *the_spaces);
    for (auto &pair : interface::find_contacts(scene, *the_mesh, *the_spaces))
      {
        log.line("contact      found between " + pair.name);
        scene.contacts.push_back(std::move(pair));
      }
    interface::check_overlap(scene, *the_mesh, *the_spaces);
    interface::check_obstacle_pairs(scene, *the_mesh, *the_spaces);
    interface::check_shared_sides(scene, *the_mesh, *the_spaces);
  }

  template <int dim>
  void StepSolver<dim>::build()
  {
    const double t = scene.load_factors.front();
    build_dual(t);
    contact::SlipLaw(scene, *the_dual, t); // refuses bounds
  }

  template <int dim>
  StepState StepSolver<dim>::state() const
  {
    StepState state;
    state.kept_part          = kept_part;
    state.largest_load       = largest_load;
    state.history            = history;
    state.rows               = rows;
    state.labels             = the_dual->constraints().label;
    state.multipliers        = values_of(the_solution.multipliers);
    state.reference          = the_solution.reference;
    state.weighted_reference = the_solution.weighted_reference;
    state.largest_traction   = the_solution.largest_traction;
    state.bolts              = bolts_so_far.state();
    for (const auto &part : u)
      state.u.emplace_back(part.data(), part.data() + part.size());
    if (the_solution.directions)
      for (std::size_t j = 0; j < the_solution.directions->size(); ++j)
        {
          const auto &direction = (*the_solution.directions)[j];
          state.directions.emplace_back(values_of(direction.p), values_of(direction.Fp));
        }
    return state;
  }

  template <int dim>
  void StepSolver<dim>::resume(const unsigned int step, const StepState &state)
  {
    kept_part    = state.kept_part;
    largest_load = state.largest_load;
    history      = state.history;
    rows         = state.rows;
    build_dual(scene.load_factors[step]);
    collectively(comm, [&] {
      bool fits = state.labels == the_dual->constraints().label && state.u.size() == the_dual->subdomains().size();
      for (std::size_t p = 0; fits && p < state.u.size(); ++p)
        fits = state.u[p].size() == the_dual->subdomains()[p]->n_unknowns();
      if (!fits)
        throw InputError("--resume: meshes or contact differ from those of the run to be continued",
                         "omit --resume to start from the first load step");
    });
    for (const auto &part : state.u)
      u.push_back(Eigen::Map<const Eigen::VectorXd>(part.data(), part.size()));
    the_solution.multipliers        = vector_of(state.multipliers, *the_dual);
    the_solution.reference          = state.reference;
    the_solution.weighted_reference = state.weighted_reference;
    the_solution.largest_traction   = state.largest_traction;
    bolts_so_far.restore(state.bolts);
    if (state.directions.empty())
      return;
    the_solution.directions =
      std::make_shared<qp::DirectionStore<tfeti::DistributedVector>>(options.newton.n_directions);
    for (const auto &[p, Fp] : state.directions)
      the_solution.directions->push(vector_of(p, *the_dual), vector_of(Fp, *the_dual), the_dual->reduction());
  }

  template <int dim>
  std::unique_ptr<StepAnswer> StepSolver<dim>::solve(const unsigned int  step,
                                                     const std::uint64_t multiplications_before)
  {
    options.tolerance = scene.solver.tolerance;
    if (bolts)
      {
        bolts_so_far.begin(wanted_tensions(scene.load_factors[step]));
        if (step == 0)
          reload(scene.load_factors[step]);
      }
    auto answer = tighten(step,
                          multiplications_before,
                          checked(solve_step(step, multiplications_before, false), scene.load_factors[step]));
    if (bolts)
      answer = tighten_bolts(step, multiplications_before, std::move(answer));
    if (step + 1 < scene.load_factors.size())
      u = answer->recovery.u;
    history.add(answer->contact->checks);
    the_solution.multipliers = answer->recovery.multipliers;
    return answer;
  }

  template <int dim>
  void StepSolver<dim>::build_dual(const double t)
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

  // A load history that returns to zero leaves rounding errors of its formulas.
  template <int dim>
  void StepSolver<dim>::drop_rounding(std::vector<Eigen::VectorXd> &loads)
  {
    constexpr double rounding = 1e-12; // of the largest load so far
    double           square   = 0;
    for (const auto &load : loads)
      square += load.squaredNorm();
    const double size = std::sqrt(dealii::Utilities::MPI::sum(square, comm));
    if (size <= rounding * largest_load)
      for (auto &load : loads)
        load.setZero();
    largest_load = std::max(largest_load, size);
  }

  template <int dim>
  std::vector<Eigen::VectorXd> StepSolver<dim>::loads_at(const double t)
  {
    auto loads = mechanics::assemble_loads(scene, *the_mesh, *the_spaces, t);
    if (bolts)
      bolts->add_loads(bolts_so_far.shortening(), loads);
    drop_rounding(loads);
    return loads;
  }

  // Again for every step if something is not held: the loads of the step may drive it.
  template <int dim>
  void StepSolver<dim>::make_dual(const double t)
  {
    scene.supports.erase(scene.supports.begin() + n_given, scene.supports.end());
    try
      {
        make_dual_as_it_is(t);
      }
    catch (const tfeti::UnheldMotions &unheld) // on all ranks alike
      {
        if (pruned.rows->size() > 0) // perhaps held by contact nodes that were left out
          throw;
        unheld_motions = in_words(unheld.motions, names_of(scene.bodies));
        std::vector<Eigen::VectorXd> motions;
        for (const auto &motion : unheld.motions)
          motions.push_back(motion.amplitudes);
        for (auto &support : mechanics::still_points(*the_mesh, *the_spaces, motions, unheld.motions.front().frames))
          scene.supports.push_back(std::move(support));
        make_dual_as_it_is(t);
      }
  }

  template <int dim>
  void StepSolver<dim>::make_dual_as_it_is(const double t)
  {
    clock.enter("assembly");
    if (subdomains)
      subdomains->set_loads(loads_at(t));
    else
      {
        auto matrices = mechanics::assemble(scene, *the_mesh, *the_spaces, t);
        if (!scene.pretensions.empty())
          {
            bolts.emplace(scene, matrices, comm);
            bolts_so_far = mechanics::Tightening(bolts->stiffnesses(), bolts->lengths());
          }
        std::vector<Eigen::VectorXd> loads;
        for (const auto &subdomain : matrices)
          loads.push_back(subdomain.load);
        drop_rounding(loads); // the first ones: the measure of later ones
        subdomains = std::make_shared<tfeti::Subdomains>(std::move(matrices));
      }
    auto rows = contact_rows(t);
    pruned    = std::move(rows.pruned);
    held      = std::move(rows.held);
    interface::refuse_held_penetration(scene, held, comm);
    print_constraints(log, rows.active);

    clock.enter("dual setup");
    the_dual.reset();
    the_dual = std::make_unique<tfeti::DualProblem>(subdomains,
                                                    std::move(rows.active),
                                                    options.dual,
                                                    names_of(scene.bodies),
                                                    comm);
    factorization += the_dual->factorization_seconds();
    print_dual(log, *the_dual);
  }

  template <int dim>
  interface::ContactRows StepSolver<dim>::contact_rows(const double t) {
    if (!contacts)
      contacts = interface::pair_bodies(scene, *the_mesh, *the_spaces);
    return interface::contact_rows(scene, *the_mesh, *the_spaces, *contacts, t, kept_part);
  }

  template <int dim>
  bool StepSolver<dim>::advance(const double t)
  {
    clock.enter("assembly");
    auto       loads = loads_at(t);
    auto       rows  = contact_rows(t);
    const bool is_same =
      scene.supports.size() == n_given &&
      dealii::Utilities::MPI::min(rows.active.label == the_dual->constraints().label ? 1 : 0, comm) > 0;
    if (is_same) // gaps that follow the load factor may prune other nodes
      {
        pruned = std::move(rows.pruned);
        held   = std::move(rows.held);
        interface::refuse_held_penetration(scene, held, comm);
        clock.enter("dual setup");
        the_dual->set_step(std::move(loads), std::move(rows.active.c));
      }
    else
      make_dual(t);
    start_slip_from_here();
    return is_same;
  }

  template <int dim>
  void StepSolver<dim>::start_slip_from_here()
  {
    auto       c     = the_dual->constraints().c;
    const auto jumps = the_dual->jumps(u);
    for (unsigned int r = 0; r < c.size(); ++r)
      if (the_dual->constraints().kind[r] == tfeti::RowKind::tangential)
        c[r] = jumps.local_element(r);
    the_dual->set_right_hand_side(std::move(c));
  }

  template <int dim>
  void StepSolver<dim>::evaluate(Answer &answer, const contact::DualSolution &from, const double t) const
  {
    const contact::SlipLaw law(scene, *the_dual, t);
    const auto            &x = answer.recovery.multipliers;
    const auto            &u = answer.recovery.u;
    answer.contact           = contact::check(*the_dual,
                                    x,
                                    u,
                                    law.depends_on_pressure() ? law.bounds(x) : from.slip_bound,
                                    from.free,
                                    scene.bodies.size(),
                                    history,
                                    bolts ? bolts->energies_beside(u, bolts_so_far.shortening(), scene.bodies.size())
                                                    : std::vector<double>());
    add_held_nodes(scene, *the_dual, held, x, u, *answer.contact);
    answer.stress =
      mechanics::recover_stress(scene, *the_mesh, *the_spaces, the_dual->constraints(), elastic_part(u), t);
  }

  template <int dim>
  bool StepSolver<dim>::is_accurate(const contact::DualSolution &iterate, const double residual_energy, const double t)
  {
    if (residual_energy > allowed_part * discretization_error)
      return false;
    try
      {
        Answer answer;
        answer.recovery = the_dual->recover(iterate.multipliers, iterate.free);
        evaluate(answer, iterate, t);
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

  template <int dim>
  std::unique_ptr<StepAnswer> StepSolver<dim>::solve_step(const unsigned int  step,
                                                          const std::uint64_t multiplications_before,
                                                          const bool          goes_on)
  {
    const double t         = scene.load_factors[step];
    bool         is_warm   = goes_on || (step > 0 && advance(t));
    qp::Counts   discarded = goes_on ? the_solution.counts : qp::Counts();
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
            the_solution =
              contact::solve_refined(*the_dual,
                                     contact::SlipLaw(scene, *the_dual, t),
                                     options,
                                     scene.friction,
                                     convergence_observer(log,
                                                          options,
                                                          step,
                                                          multiplications_before + discarded.hessian_multiplications,
                                                          rows),
                                     is_warm ? &the_solution : nullptr,
                                     test);
            discarded += the_solution.counts;
            the_solution.counts = discarded;
            clock.enter("recovery");
            auto answer = std::move(accepted);
            if (!answer)
              {
                answer           = std::make_unique<Answer>();
                answer->recovery = recovered();
              }
            const double penetration = interface::largest_penetration(pruned, answer->recovery.u, comm);
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
        log.line("pruning      " + reason + ": solving again with more of them");
        make_dual(t);
        if (step > 0)
          start_slip_from_here();
      }
  }

  // If the solution did not converge, work of the loads along a free motion proves nothing; all rows then count as
  // holding.
  template <int dim>
  tfeti::DualProblem::Recovery StepSolver<dim>::recovered() const
  {
    try
      {
        // motions that nothing resists and no load drives are kept at zero
        return the_dual->recover(the_solution.multipliers, the_solution.free, true);
      }
    catch (const UndeterminedPosition &)
      {
        throw;
      }
    catch (const NoEquilibrium &) // on all ranks alike
      {
        if (the_solution.status == qp::Status::converged || pruned.rows->size() > 0)
          throw;
        return the_dual->recover(the_solution.multipliers, std::vector<bool>(the_solution.free.size(), true));
      }
  }

  template <int dim>
  std::unique_ptr<StepAnswer> StepSolver<dim>::checked(std::unique_ptr<Answer> answer, const double t) const
  {
    if (!answer->stress)
      evaluate(*answer, the_solution, t);
    return answer;
  }

  template <int dim>
  std::unique_ptr<StepAnswer> StepSolver<dim>::tighten(const unsigned int      step,
                                                       const std::uint64_t     multiplications_before,
                                                       std::unique_ptr<Answer> answer)
  {
    const double limit = check_limit(tolerance_of(scene.solver, the_solution));
    for (unsigned int n = 0; n < max_tightenings && the_solution.status == qp::Status::converged; ++n)
      {
        const auto   worst = answer->contact->checks.worst_entry();
        const double reached =
          std::min(options.tolerance, std::max(the_solution.projected_gradient, the_solution.equality));
        if (worst.value <= limit || worst.is_balance)
          break;
        // also if the answer is not a number
        const double excess = std::min(largest_tightening, std::max(least_tightening, worst.value / limit));
        options.tolerance   = std::max(reached / (margin_of_tightening * excess), least_tolerance);
        if (options.tolerance < tolerance_of_rounding && close_gaps(*answer, step, limit))
          break;
        if (reached <= least_tolerance)
          break;
        log.line(format("checks       %s is %.1e, allowed is %.1e: continuing with a tolerance of %.1e",
                        worst.name,
                        worst.value,
                        limit,
                        options.tolerance));
        const auto   before      = the_solution;
        const double kept        = kept_part;
        the_solution.multipliers = answer->recovery.multipliers;
        auto next                = checked(solve_step(step, multiplications_before, true), scene.load_factors[step]);
        if (kept_part != kept || (the_solution.status == qp::Status::converged &&
                                  (worst.value > of_no_answer || next->contact->checks.worst().second < worst.value)))
          answer = std::move(next); // the first: it got rows for more contact nodes
        else
          { // it did converge to the tolerance requested
            const auto counts   = the_solution.counts;
            the_solution        = before;
            the_solution.counts = counts;
            break;
          }
      }
    return answer;
  }

  template <int dim>
  bool StepSolver<dim>::close_gaps(Answer &answer, const unsigned int step, const double limit)
  {
    double worst = answer.contact->checks.worst().second;
    for (unsigned int n = 0; n < max_closings && worst > limit; ++n)
      {
        Answer next;
        next.recovery = answer.recovery;
        the_solution.counts += contact::close_gaps(*the_dual, the_solution.free, options.pcpg, next.recovery);
        evaluate(next, the_solution, scene.load_factors[step]);
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
