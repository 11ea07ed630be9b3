#include <slipstick/app/report.h>
#include <slipstick/app/simulation.h>
#include <slipstick/fem/arc_length.h>
#include <slipstick/fem/assembly.h>
#include <slipstick/fem/contact_constraints.h>
#include <slipstick/fem/decomposition.h>
#include <slipstick/output/contact_line.h>
#include <slipstick/output/convergence.h>
#include <slipstick/output/fields.h>

#include <deal.II/base/mpi.h>

#include <boost/serialization/array.hpp>
#include <boost/serialization/vector.hpp>

namespace slipstick::app
{
  namespace
  {
    constexpr int    dim         = 2;
    constexpr double load_factor = 1; // t of the one load step

    std::vector<std::string> names_of(const std::vector<scene::Body<dim>> &bodies)
    {
      std::vector<std::string> names;
      for (const auto &body : bodies)
        names.push_back(body.name);
      return names;
    }

    /// Observer of the solver: a line on the console and a row of convergence.csv.
    qp::Observer convergence_observer(const Log                           &log,
                                      const scene::Algorithm               algorithm,
                                      const double                         tolerance,
                                      std::vector<output::ConvergenceRow> &rows)
    {
      log.line(format("solve        %s until projected gradient gP and violation of G x = e are below %g |Pd|",
                      name_of(algorithm).c_str(),
                      tolerance));
      log.line("              step  F-multiplications  |gP|/|Pd|  |Gx|/|Pd|  at a bound");
      return [&log, algorithm, &rows](const qp::OuterStep &step) {
        output::ConvergenceRow row;
        row.algorithm               = name_of(algorithm);
        row.outer_step              = step.outer;
        row.hessian_multiplications = step.hessian_multiplications;
        row.projected_gradient      = step.projected_gradient;
        row.equality                = step.equality_residual;
        row.at_lower_bound          = step.active_lower;
        row.at_upper_bound          = step.active_upper;
        rows.push_back(row);
        log.line(format("             %5u  %17u  %9.2e  %9.2e  %10zu",
                        step.outer,
                        step.hessian_multiplications,
                        step.projected_gradient,
                        step.equality_residual,
                        step.active_lower + step.active_upper));
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
      time.mesh          = clock.seconds("mesh");
      time.assembly      = clock.seconds("assembly");
      time.factorization = factorization;
      time.dual_setup    = clock.seconds("dual setup") - factorization;
      time.solve         = clock.seconds("solve");
      time.recovery      = clock.seconds("recovery");
      time.output        = clock.seconds("output");
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

    void write_fields(const scene::Scene<dim>            &scene,
                      const fem::Mesh<dim>               &mesh,
                      const fem::Spaces<dim>             &spaces,
                      const std::vector<Eigen::VectorXd> &u,
                      const fem::StressResult            &stress,
                      const output::OutputDirectory      &directory)
    {
      if (!scene.output.vtu)
        return;
      output::write_fields(directory, mesh, spaces, u, stress, 0);
      output::write_pvd(directory, {load_factor});
    }

    /// The contact line, and its sums (on rank 0).
    std::vector<contact::PairResult> write_contact(const scene::Scene<dim>       &scene,
                                                   const fem::Mesh<dim>          &mesh,
                                                   const fem::Spaces<dim>        &spaces,
                                                   const contact::CheckedContact &contact,
                                                   const output::OutputDirectory &directory)
    {
      if (!scene.has_contact())
        return {};
      output::ContactNames names;
      for (const auto &pair : scene.contacts)
        {
          names.pairs.push_back(pair.name);
          names.slave_bodies.push_back(scene.bodies[pair.slave.body].name);
        }
      const auto step = gather_contact(scene, mesh, spaces, contact);
      output::write_contact_csv(directory, names, {step});
      output::write_contact_vtp(directory, step);
      return contact::pair_results(step.nodes, names.pairs);
    }

    ExitStatus solve_and_write(const scene::Scene<dim>       &scene,
                               const output::OutputDirectory &directory,
                               const Log                     &log,
                               const MPI_Comm                 comm)
    {
      StageClock clock;
      const auto options = contact::resolved_options(scene);
      print_header(log, scene, comm);

      clock.enter("mesh");
      const auto             mesh = fem::make_mesh(scene, comm);
      const fem::Spaces<dim> spaces(mesh, scene.discretization.degree);
      print_mesh(log, scene, mesh, spaces);

      clock.enter("assembly");
      auto matrices    = fem::assemble(scene, mesh, spaces, load_factor);
      auto constraints = fem::contact_constraints(scene, mesh, spaces, load_factor);
      print_constraints(log, constraints);

      clock.enter("dual setup");
      const tfeti::DualProblem dual(std::move(matrices),
                                    std::move(constraints),
                                    options.dual,
                                    names_of(scene.bodies),
                                    comm);
      const auto               slip_bound = contact::slip_bounds(scene, dual, load_factor);
      print_dual(log, dual);

      clock.enter("solve");
      directory.remove_results(); // the scene is accepted: what an earlier run left is no longer true
      std::vector<output::ConvergenceRow> convergence;
      const auto                          solution =
        contact::solve(dual,
                       slip_bound,
                       options,
                       convergence_observer(log, options.algorithm, options.tolerance, convergence));

      clock.enter("recovery");
      const auto recovery = dual.recover(solution.multipliers, solution.free);
      const auto contact =
        contact::check(dual, recovery.multipliers, recovery.u, slip_bound, solution.free, scene.bodies.size());
      const auto stress = fem::recover_stress(scene, mesh, spaces, dual.constraints(), recovery.u, load_factor);
      print_checks(log, solution, contact.checks, scene.solver.tolerance);

      clock.enter("output");
      auto summary = make_summary(scene, mesh, spaces, dual, solution, contact.checks, stress);
      write_fields(scene, mesh, spaces, recovery.u, stress, directory);
      output::write_convergence(directory, convergence);
      directory.write_from_root("parameters.prm", [&](std::ostream &out) { out << scene.parameters; });
      summary.results.contact = write_contact(scene, mesh, spaces, contact, directory);
      clock.leave();
      summary.time_s    = times(clock, dual.factorization_seconds());
      summary.memory_mb = memory(comm);
      output::write_summary(directory, summary);
      print_result(log, summary, contact.checks, directory.path(scene.output.vtu ? "solution.pvd" : "summary.json"));
      return summary.status == output::RunStatus::converged ? ExitStatus::converged : ExitStatus::not_converged;
    }
  } // namespace

  void check_scene(const scene::Scene<dim> &scene, const Log &log, const MPI_Comm comm)
  {
    print_header(log, scene, comm);
    const auto             mesh = fem::make_mesh(scene, comm);
    const fem::Spaces<dim> spaces(mesh, scene.discretization.degree);
    print_mesh(log, scene, mesh, spaces);
    auto constraints = fem::contact_constraints(scene, mesh, spaces, load_factor);
    print_constraints(log, constraints);
    const tfeti::DualProblem dual(fem::assemble(scene, mesh, spaces, load_factor),
                                  std::move(constraints),
                                  contact::resolved_options(scene).dual,
                                  names_of(scene.bodies),
                                  comm);
    print_dual(log, dual);
    contact::slip_bounds(scene, dual, load_factor);
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
        return solve_and_write(scene, directory, log, comm);
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
