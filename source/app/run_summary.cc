#include <slipstick/app/names.h>
#include <slipstick/app/run_summary.h>

#include <deal.II/base/mpi.h>

#include <algorithm>
#include <cmath>

namespace slipstick::app
{
  double tolerance_of(const scene::SolverOptions &options, const contact::DualSolution &solution)
  {
    return options.stops_at_discretization_error && solution.status == qp::Status::converged
             ? std::max({options.tolerance, solution.projected_gradient, solution.equality})
             : options.tolerance;
  }

  double check_limit(const double tolerance)
  {
    return std::min(largest_limit, check_factor * tolerance);
  }

  bool passes(const contact::DualSolution &solution, const contact::Checks &checks, const double tolerance)
  {
    return solution.status == qp::Status::converged && checks.worst().second <= check_limit(tolerance);
  }

  template <int dim>
  output::Summary empty_summary(const scene::Scene<dim> &scene, const MPI_Comm comm)
  {
    output::Summary s;
    s.case_name         = scene.name;
    s.version           = SLIPSTICK_VERSION;
    s.ranks             = dealii::Utilities::MPI::n_mpi_processes(comm);
    s.problem.bodies    = scene.bodies.size();
    s.problem.dimension = dim;
    return s;
  }

  void add_step(const output::Summary &so_far, const double load_factor, output::Summary &summary)
  {
    output::StepSummary step;
    step.load_factor             = load_factor;
    step.hessian_multiplications = summary.solver.hessian_multiplications;
    step.outer_iterations        = summary.solver.outer_iterations;
    step.coulomb_iterations      = summary.solver.coulomb_iterations;
    step.max_displacement        = summary.results.max_displacement;
    step.strain_energy           = summary.results.strain_energy;
    step.contact                 = summary.results.contact;
    step.forces                  = summary.results.forces;
    step.probes                  = summary.results.probes;
    step.pretensions             = summary.results.pretensions;
    summary.steps                = so_far.steps;
    summary.steps.push_back(std::move(step));

    summary.solver.hessian_multiplications += so_far.solver.hessian_multiplications;
    summary.solver.preconditioner_applications += so_far.solver.preconditioner_applications;
    summary.solver.outer_iterations += so_far.solver.outer_iterations;
    summary.solver.cg_steps += so_far.solver.cg_steps;
    summary.solver.expansion_steps += so_far.solver.expansion_steps;
    summary.solver.proportioning_steps += so_far.solver.proportioning_steps;
    summary.solver.coulomb_iterations += so_far.solver.coulomb_iterations;
    summary.solver.fallbacks += so_far.solver.fallbacks;
    for (double output::ResidualSummary::*residual : {&output::ResidualSummary::projected_gradient,
                                                      &output::ResidualSummary::equality,
                                                      &output::ResidualSummary::interface_jump,
                                                      &output::ResidualSummary::penetration,
                                                      &output::ResidualSummary::complementarity,
                                                      &output::ResidualSummary::friction_bound,
                                                      &output::ResidualSummary::force_balance,
                                                      &output::ResidualSummary::moment_balance,
                                                      &output::ResidualSummary::tension,
                                                      &output::ResidualSummary::nodal_equilibrium})
      summary.residuals.*residual = std::max(summary.residuals.*residual, so_far.residuals.*residual);
  }

  template <int dim>
  void drop_moments(const scene::Scene<dim> &scene, output::ResultSummary &results)
  {
    if (scene.plane_state != scene::PlaneState::axisymmetric)
      return;
    for (auto *list : {&results.forces.loads, &results.forces.supports, &results.forces.foundations})
      for (auto &one : *list)
        one.sum.moment = {{0, 0, 0}};
    for (auto &pair : results.contact)
      pair.on_slave.moment = pair.moment_mismatch = {{0, 0, 0}};
  }

  double largest_force(const output::ResultSummary &results)
  {
    double largest = 0;
    for (const auto *list : {&results.forces.loads, &results.forces.supports})
      for (const auto &one : *list)
        for (const double force : one.sum.force)
          largest = std::max(largest, std::abs(force));
    for (const auto &pair : results.contact)
      largest = std::max({largest, std::abs(pair.normal_force), std::abs(pair.tangential_force)});
    return largest;
  }

  template <int dim>
  output::Summary make_summary(const scene::Scene<dim>       &scene,
                               const mesh::Mesh<dim>         &mesh,
                               const mechanics::Spaces<dim>  &spaces,
                               const tfeti::DualProblem      &dual,
                               const contact::DualSolution   &solution,
                               const contact::Checks         &checks,
                               const mechanics::StressResult &stress)
  {
    const auto     &n         = dual.constraints().counts;
    const double    tolerance = tolerance_of(scene.solver, solution);
    output::Summary s         = empty_summary(scene, mesh.comm);
    s.status = passes(solution, checks, tolerance) ? output::RunStatus::converged : output::RunStatus::not_converged;

    s.problem.plane_state        = dim == 3 ? "solid" : name_of(scene.plane_state);
    s.problem.bodies             = scene.bodies.size();
    s.problem.subdomains         = mesh.n_subdomains();
    s.problem.primal_dofs        = spaces.n_dofs;
    s.problem.kernel_dimension   = dual.projector().dimension();
    s.problem.cells              = mesh.n_cells;
    s.problem.dual               = {n.total(), n.gluing + n.prescribed, n.normal, n.tangential};
    s.problem.contact_candidates = n.candidates;

    s.solver.algorithm                   = name_of(solution.algorithm);
    s.solver.preconditioner              = name_of(contact::resolved_options(scene).dual.preconditioner);
    s.solver.dual_operator               = dual.dual_operator().is_explicit() ? "explicit" : "implicit";
    s.solver.tolerance                   = tolerance;
    s.solver.hessian_multiplications     = solution.counts.hessian_multiplications;
    s.solver.dual_setup_multiplications  = dual.set_up().multiplications;
    s.solver.preconditioner_applications = solution.counts.preconditioner_applications;
    s.solver.outer_iterations            = solution.counts.outer_iterations;
    s.solver.cg_steps                    = solution.counts.cg_steps;
    s.solver.expansion_steps             = solution.counts.expansion_steps;
    s.solver.proportioning_steps         = solution.counts.proportioning_steps;
    s.solver.coulomb_iterations          = solution.friction_iterations;
    s.solver.fallbacks                   = solution.fallbacks;
    s.solver.active_constraints          = solution.active_constraints;
    s.solver.dual_norm                   = dual.norm();

    s.residuals.projected_gradient = solution.projected_gradient;
    s.residuals.equality           = solution.equality;
    s.residuals.interface_jump     = checks.interface_jump;
    s.residuals.penetration        = checks.penetration;
    s.residuals.complementarity    = checks.complementarity;
    s.residuals.friction_bound     = checks.friction_bound;
    s.residuals.force_balance      = checks.force_balance;
    s.residuals.moment_balance     = checks.moment_balance;
    s.residuals.tension            = checks.tension;
    s.residuals.nodal_equilibrium  = checks.nodal_equilibrium;

    const double total               = stress.energy_squared + stress.error_squared;
    s.error.estimate_energy_relative = total > 0 ? std::sqrt(stress.error_squared / total) : 0.;
    s.error.algebraic_relative       = checks.algebraic_error;
    s.results.max_displacement       = checks.max_displacement;
    s.results.max_von_mises          = stress.max_von_mises;
    s.results.strain_energy          = checks.energy / 2;
    if (stress.has_hoop_stress)
      s.results.hoop_stress = std::array<double, 2>{{stress.min_hoop_stress, stress.max_hoop_stress}};
    return s;
  }

  template output::Summary empty_summary(const scene::Scene<2> &, const MPI_Comm);
  template void            drop_moments(const scene::Scene<2> &, output::ResultSummary &);
  template output::Summary make_summary(const scene::Scene<2> &,
                                        const mesh::Mesh<2> &,
                                        const mechanics::Spaces<2> &,
                                        const tfeti::DualProblem &,
                                        const contact::DualSolution &,
                                        const contact::Checks &,
                                        const mechanics::StressResult &);
  template output::Summary empty_summary(const scene::Scene<3> &, const MPI_Comm);
  template void            drop_moments(const scene::Scene<3> &, output::ResultSummary &);
  template output::Summary make_summary(const scene::Scene<3> &,
                                        const mesh::Mesh<3> &,
                                        const mechanics::Spaces<3> &,
                                        const tfeti::DualProblem &,
                                        const contact::DualSolution &,
                                        const contact::Checks &,
                                        const mechanics::StressResult &);
} // namespace slipstick::app
