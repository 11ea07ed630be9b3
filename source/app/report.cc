#include <slipstick/app/names.h>
#include <slipstick/app/report.h>
#include <slipstick/base/text.h>
#include <slipstick/contact/contact_algorithms.h>
#include <slipstick/scene/checks.h>

#include <deal.II/base/config.h>
#include <deal.II/base/mpi.h>

#include <Trilinos_version.h>

#include <algorithm>
#include <cmath>

namespace slipstick::app
{
  namespace
  {
    // Smaller residuals are rounding errors in the operators of the solver.
    constexpr double residual_rounding = 1e-11;
    // Rounding errors of different ways of computing the same quantity differ by about this factor.
    constexpr double margin_of_rounding = 2;
    // Changes of gaps below this fraction of the size of the bodies are not reported.
    constexpr double shown_change_of_gaps = 1e-12;

    std::string line(const char *stage, const std::string &text)
    {
      return format("%-12s ", stage) + text;
    }

    /// "(1, 2)"; components that are rounding errors compared with the largest are set to 0.
    std::string rounded_place(std::array<double, 3> x, const unsigned int dim)
    {
      constexpr double rounding = 1e-12;
      double           largest  = 0;
      for (const double component : x)
        largest = std::max(largest, std::abs(component));
      for (double &component : x)
        if (std::abs(component) <= rounding * largest)
          component = 0;
      return point_text(x, dim);
    }

    /// " at (1, 2) of body box, contact joint"
    template <int dim>
    std::string place(const scene::Scene<dim> &scene, const contact::Place &place)
    {
      if (!place.is_known)
        return "";
      std::string text = place.is_point ? " at " + point_text(place.position, dim) + " of" : std::string(" of");
      text += " body " + scene.bodies[place.body].name;
      return text + (place.in_pair ? ", contact " + scene.contacts[place.pair].name : "");
    }
  } // namespace

  template <int dim>
  void print_header(const Log &log, const scene::Scene<dim> &scene, const MPI_Comm comm)
  {
    log.line(format("slipstick %s (deal.II %s, Trilinos %s), MPI ranks: %u",
                    SLIPSTICK_VERSION,
                    DEAL_II_PACKAGE_VERSION,
                    TRILINOS_VERSION_STRING,
                    dealii::Utilities::MPI::n_mpi_processes(comm)));
    log.line(scene.name + (scene.title.empty() ? "" : ": " + scene.title));
    const auto &solver = scene.solver;
    log.line(line("accuracy",
                  format("%s: tolerance %s, slip bounds %g, degree %u, operator in %s precision, contact nodes %s",
                         name_of(scene.accuracy).c_str(),
                         solver.stops_at_discretization_error ? "auto" : format("%g", solver.tolerance).c_str(),
                         scene.friction.tolerance,
                         scene.discretization.degree,
                         solver.dual.operator_precision == tfeti::Precision::single_precision ? "single" : "double",
                         solver.prune_contact ? "pruned" : "all kept")));
    if (scene.plane_state == scene::PlaneState::axisymmetric)
      log.line(
        line("axisymmetric",
             "x is the radius, y the axis, zz the hoop direction; all forces are those over the whole circumference"));
  }

  template <int dim>
  void print_mesh(const Log                    &log,
                  const scene::Scene<dim>      &scene,
                  const mesh::Mesh<dim>        &mesh,
                  const mechanics::Spaces<dim> &spaces)
  {
    log.line(line("mesh",
                  format("bodies: %zu, cells: %llu of degree %u, subdomains: %u (%s), unknowns: %llu",
                         scene.bodies.size(),
                         static_cast<unsigned long long>(mesh.n_cells),
                         scene.discretization.degree,
                         mesh.n_subdomains(),
                         name_of(scene.decomposition.method).c_str(),
                         spaces.n_dofs)));
    for (const auto &remark : mesh.remarks)
      log.remark(remark.line());
    for (const auto &warning : scene::warnings(scene))
      log.remark("warning: " + warning);
    for (unsigned int b = 0; b < scene.bodies.size(); ++b)
      {
        std::string names;
        for (const auto &[name, id] : mesh.boundary_ids[b])
          names += (names.empty() ? "" : ", ") + name + format(" (%u)", id);
        log.detail(line("", "body " + scene.bodies[b].name + ": boundaries " + names));
      }
  }

  template <int dim>
  std::vector<std::string> warnings_before(const scene::Scene<dim> &scene, const mesh::Mesh<dim> &mesh)
  {
    std::vector<std::string> texts;
    for (const auto &remark : mesh.remarks)
      if (remark.is_warning)
        texts.push_back(remark.text);
    for (const auto &warning : scene::warnings(scene))
      texts.push_back(warning);
    return texts;
  }

  void print_constraints(const Log &log, const tfeti::Constraints &constraints)
  {
    const auto &n = constraints.counts;
    log.line(
      line("constraints",
           format("%llu multipliers: %llu gluing, %llu supports, %llu normal, %llu tangential; %llu contact candidates",
                  n.total(),
                  n.gluing,
                  n.prescribed,
                  n.normal,
                  n.tangential,
                  n.candidates)));
  }

  void print_dual(const Log &log, const tfeti::DualProblem &dual)
  {
    log.line(line("dual",
                  format("%s F, kernel %llu, |PFP| = %.4g mm/N estimated with %llu multiplications",
                         dual.dual_operator().is_explicit() ? "explicit" : "implicit",
                         dual.projector().dimension(),
                         dual.norm(),
                         dual.set_up().multiplications)));
    if (const double changed = dual.contradiction_of_gaps();
        changed > shown_change_of_gaps * dual.body_motions().largest_length())
      log.line(
        line("",
             format("gaps around points where bodies form a loop contradict each other, as rounded node positions do: "
                    "changed by up to %.1e mm",
                    changed)));
  }

  void print_checks(const Log &log, const contact::Checks &checks, const double tolerance)
  {
    log.line(line("checks", format("from the displacement, relative, allowed %.1e:", check_limit(tolerance))));
    log.line(line("",
                  format("jump %.1e, penetration %.1e, complementarity %.1e, tension %.1e, friction %.1e",
                         checks.interface_jump,
                         checks.penetration,
                         checks.complementarity,
                         checks.tension,
                         checks.friction_bound)));
    log.line(line("",
                  format("nodal equilibrium %.1e; bodies: forces %.1e, moments %.1e",
                         checks.nodal_equilibrium,
                         checks.force_balance,
                         checks.moment_balance)));
  }

  namespace
  {
    /// Whether the value is an admissible tolerance.
    bool is_tolerance(const double value)
    {
      return value > 0 && value < 1;
    }
  } // namespace

  namespace
  {
    /// The solver converged, but a check of the displacement fails.
    std::string failed_check(const contact::DualSolution  &solution,
                             const contact::Checks::Entry &worst,
                             const std::string            &where,
                             const double                  tolerance)
    {
      const double      reached   = std::max(solution.projected_gradient, solution.equality);
      const double      reachable = rounded_up(margin_of_rounding * worst.value / check_factor);
      const std::string what =
        format("the check from the recovered displacement fails: %s is %.2e%s, allowed is %.2e; the solver reached "
               "residuals of %.1e",
               worst.name,
               worst.value,
               where.c_str(),
               check_limit(tolerance),
               reached);
      if (!worst.is_balance && reached > residual_rounding)
        return what + format("\n  remedy: set Solver/Tolerance to %.1g, and check the residuals in convergence.csv",
                             reached / check_factor);
      return what + "; iterating further does not help, since this is rounding\n  remedy: " +
             (check_factor * reachable <= largest_limit
                ? format(
                    "set Solver/Tolerance to %g or more (now %g), or bring moduli, sizes and thicknesses closer together",
                    reachable,
                    tolerance)
                : std::string(
                    "double precision is not sufficient for this scene: bring moduli, sizes and thicknesses closer "
                    "together, and also the edges of its elements"));
    }

    /// The residuals are small, but the slip bounds still change.
    std::string unsettled_bounds(const contact::DualSolution &solution, const std::string &largest)
    {
      return format("not converged: the slip bounds still change by %.1e of their norm after %u updates",
                    solution.bound_change,
                    solution.friction_iterations) +
             largest +
             "; the results are written but are not a solution\n"
             "  remedy: split the load into more steps (Load steps/Factors), " +
             (is_tolerance(rounded_up(solution.bound_change))
                ? format("set Friction/Tolerance to %g or more, ", rounded_up(solution.bound_change))
                : "") +
             "or raise Friction/Max iterations; with a large friction coefficient there may be no or many solutions";
    }

    /// No tolerance would help.
    std::string inconsistent_forces(const contact::DualSolution &solution,
                                    const std::string           &largest,
                                    const bool                   balances)
    {
      return (balances
                ? format("not converged: friction and normal forces do not converge to consistent values (residuals "
                         "of %.1e of |Pd|)",
                         std::max(solution.projected_gradient, solution.equality))
                : format("not converged: the contact forces found do not balance the loads (violation of G x = e of "
                         "%.1e of |Pd|)",
                         solution.equality)) +
             largest +
             "; the results are not a solution\n  remedy: support bodies that friction alone holds, press them together "
             "(before they are loaded along the contact: Load steps/Factors), or lower the load";
    }

    /// The residuals are above the tolerance.
    /// @param asked the algorithm that the scene asks for.
    std::string missed_tolerance(const contact::DualSolution &solution,
                                 const scene::Algorithm       asked,
                                 const std::string           &largest,
                                 const double                 tolerance)
    {
      const double reached     = std::max(solution.projected_gradient, solution.equality);
      const bool   limit       = solution.status == qp::Status::iteration_limit;
      const bool   is_given_up = // beyond the limit of the default algorithm, which no option raises
        asked != scene::Algorithm::smalbe && solution.counts.hessian_multiplications > contact::longest_fallback;
      const std::string raise =
        is_tolerance(rounded_up(reached))
          ? format("set Solver/Tolerance to %g or more, and check the residuals in convergence.csv",
                   rounded_up(reached))
          : "check the residuals in convergence.csv; possible causes are loads and supports that are barely in equilibrium, "
            "and very different moduli or sizes";
      return format("not converged: the solver %s: %s is %.1e of |Pd|, the tolerance is %g",
                    limit ? "reached its iteration limit" : "stagnated",
                    solution.projected_gradient >= solution.equality ? "the projected gradient"
                                                                     : "the violation of G x = e",
                    reached,
                    tolerance) +
             largest + "; the results are not a solution\n  remedy: " +
             (!limit                                        ? raise
              : solution.algorithm == scene::Algorithm::pcg ? "raise Solver/PCG/Max iterations"
              : is_given_up ? "split the load into more steps (Load steps/Factors), or " + raise
                            : "raise Solver/SMALBE/Max outer iterations or Max inner iterations");
    }
  } // namespace

  template <int dim>
  void print_failure(const Log                   &log,
                     const scene::Scene<dim>     &scene,
                     const contact::DualSolution &solution,
                     const contact::Checks       &checks,
                     const double                 tolerance)
  {
    const auto        worst = checks.worst_entry();
    const std::string where = place(scene, worst.place);
    if (solution.status == qp::Status::converged)
      return log.warning(failed_check(solution, worst, where, tolerance));
    const std::string largest =
      format("; largest error of the displacement: %s %.1e%s", worst.name, worst.value, where.c_str());
    const bool balances = solution.equality <= tolerance;
    const bool reached  = solution.projected_gradient <= tolerance && balances;
    if (reached && solution.friction_iterations > 0)
      return log.warning(unsettled_bounds(solution, largest));
    if (reached ||
        (solution.algorithm != scene::Algorithm::pcg && solution.status != qp::Status::iteration_limit && !balances))
      return log.warning(inconsistent_forces(solution, largest, balances));
    log.warning(missed_tolerance(solution, scene.solver.algorithm, largest, tolerance));
  }

  namespace
  {
    template <int dim>
    std::string row(const std::string &what, const Resultant &sum, const bool is_revolution)
    {
      std::string text = format("             %-30s", what.c_str());
      for (unsigned int d = 0; d < dim; ++d)
        text += format(" %14.6g", sum.force[d]);
      for (unsigned int d = dim == 2 ? 2 : 0; d < 3 && !is_revolution; ++d)
        text += format(" %16.6g", sum.moment[d]);
      return text;
    }
  } // namespace

  template <int dim>
  void print_forces(const Log &log, const scene::Scene<dim> &scene, const output::ResultSummary &results)
  {
    const bool is_revolution = scene.plane_state == scene::PlaneState::axisymmetric;
    Resultant  left;
    if (is_revolution)
      log.line(format("forces       %-30s %14s %14s", "on the whole circumference", "radial [N]", "axial [N]"));
    else if (dim == 2)
      log.line(format("forces       %-30s %14s %14s %16s", "on the bodies", "Fx [N]", "Fy [N]", "moment [N mm]"));
    else
      log.line(format("forces       %-30s %14s %14s %14s %16s %16s %16s",
                      "on the bodies",
                      "Fx [N]",
                      "Fy [N]",
                      "Fz [N]",
                      "Mx [N mm]",
                      "My [N mm]",
                      "Mz [N mm]"));
    const auto count = [&left](const Resultant &sum) { left += sum; };
    for (const auto *list : {&results.forces.loads, &results.forces.supports, &results.forces.foundations})
      for (const auto &one : *list)
        {
          log.line(row<dim>(one.kind + " " + one.name, one.sum, is_revolution));
          count(one.sum);
        }
    for (unsigned int k = 0; k < results.contact.size(); ++k)
      {
        const auto &pair = scene.contacts[k];
        log.line(row<dim>("contact " + pair.name + (pair.master ? " on " + scene.bodies[pair.slave.body].name : ""),
                          results.contact[k].on_slave,
                          is_revolution));
        if (!pair.master)
          count(results.contact[k].on_slave);
      }
    if (is_revolution) // radial forces are balanced around the circumference
      log.line(format("             %-30s %14s %14.6g", "sum of external forces", "", left.force[1]));
    else
      log.line(row<dim>("sum of external forces", left, is_revolution));
  }

  namespace
  {
    /// ", algebraic about 0.1 % of the pressures (pair) and 1 % of the tangential tractions (pair)": the largest of all
    /// pairs; empty without errors.
    std::string errors_of_tractions(const std::vector<contact::PairResult> &pairs)
    {
      const auto largest = [&pairs](double contact::PairTractions::*part, const char *of) {
        const auto pair = std::max_element(pairs.begin(), pairs.end(), [part](const auto &a, const auto &b) {
          return a.algebraic_error.*part < b.algebraic_error.*part;
        });
        if (pair == pairs.end() || !((*pair).algebraic_error.*part > 0))
          return std::string();
        const std::string where = pairs.size() > 1 ? " (" + pair->pair + ")" : "";
        return format("%.1g %% of the %s", 100 * pair->algebraic_error.*part, of) + where;
      };
      const std::string pressures  = largest(&contact::PairTractions::pressure, "pressures"),
                        tangential = largest(&contact::PairTractions::tangential, "tangential tractions");
      if (pressures.empty() && tangential.empty())
        return "";
      return ", about " + pressures + (pressures.empty() || tangential.empty() ? "" : " and ") + tangential + " in L2";
    }
  } // namespace

  void print_result(const Log &log, const output::Summary &summary, const std::string &pvd)
  {
    const unsigned int dim = summary.problem.dimension;
    log.line("");
    for (const auto &pair : summary.results.contact)
      log.line(format(
        "contact %s: largest pressure %.6g MPa; %u nodes in contact, %u open; %u stick, %u slip%s; forces summed along it %.6g N normal, %.6g N tangential",
        pair.pair.c_str(),
        pair.max_pressure,
        pair.contact_nodes,
        pair.open_nodes,
        pair.stick_nodes,
        pair.slip_nodes,
        pair.open_slip_nodes > 0 ? format(" (%u of them open)", pair.open_slip_nodes).c_str() : "",
        pair.normal_force,
        pair.tangential_force));
    log.line(
      format(
        "largest displacement %.6g mm, largest von Mises stress %.6g MPa, strain energy %.6g N mm; errors in the energy norm: discretisation about %.2g %%, algebraic below %.2g %%",
        summary.results.max_displacement,
        summary.results.max_von_mises,
        summary.results.strain_energy,
        100 * summary.error.estimate_energy_relative,
        100 * summary.error.algebraic_relative) +
      errors_of_tractions(summary.results.contact));
    for (const auto &probe : summary.results.probes)
      if (probe.is_point)
        {
          const auto &found = probe.points.front();
          log.line(format("probe %s at %s: displacement %s mm, von Mises stress %.6g MPa",
                          probe.name.c_str(),
                          point_text(found.position, dim).c_str(),
                          point_text(found.displacement, dim).c_str(),
                          found.von_mises));
        }
    const auto &peak = summary.results.max_von_mises_at, &error = summary.error.largest_at;
    log.line(format("von Mises stress is largest in body %s at %s%s; the cell with the largest error, %.2g %% of the "
                    "square of all, is at %s of body %s",
                    peak.body.c_str(),
                    rounded_place(peak.position, dim).c_str(),
                    summary.results.singular.empty()
                      ? ""
                      : (", " + summary.results.singular + ", where it grows without limit under refinement").c_str(),
                    100 * summary.error.largest_part,
                    rounded_place(error.position, dim).c_str(),
                    error.body.c_str()));
    log.line(format("%s after %llu F-multiplications in %u outer steps; equilibrium error %.1e; %.2f s, %.0f MB",
                    summary.is_inaccurate ? "accuracy not reached" : output::to_string(summary.status).c_str(),
                    static_cast<unsigned long long>(summary.solver.hessian_multiplications),
                    summary.solver.outer_iterations,
                    std::max({summary.residuals.nodal_equilibrium,
                              summary.residuals.force_balance,
                              summary.residuals.moment_balance}),
                    summary.time_s.total,
                    summary.memory_mb.peak_total));
    log.line("open " + pvd);
  }

  template void print_header(const Log &, const scene::Scene<2> &, const MPI_Comm);
  template void print_mesh(const Log &, const scene::Scene<2> &, const mesh::Mesh<2> &, const mechanics::Spaces<2> &);
  template std::vector<std::string> warnings_before(const scene::Scene<2> &, const mesh::Mesh<2> &);
  template void                     print_failure(const Log &,
                                                  const scene::Scene<2> &,
                                                  const contact::DualSolution &,
                                                  const contact::Checks &,
                                                  const double);
  template void                     print_forces(const Log &, const scene::Scene<2> &, const output::ResultSummary &);
  template void                     print_header(const Log &, const scene::Scene<3> &, const MPI_Comm);
  template void print_mesh(const Log &, const scene::Scene<3> &, const mesh::Mesh<3> &, const mechanics::Spaces<3> &);
  template std::vector<std::string> warnings_before(const scene::Scene<3> &, const mesh::Mesh<3> &);
  template void                     print_failure(const Log &,
                                                  const scene::Scene<3> &,
                                                  const contact::DualSolution &,
                                                  const contact::Checks &,
                                                  const double);
  template void                     print_forces(const Log &, const scene::Scene<3> &, const output::ResultSummary &);
} // namespace slipstick::app
