#include <slipstick/output/summary.h>

#include <deal.II/base/exceptions.h>

#include <nlohmann/json.hpp>

#include <ostream>

namespace slipstick::output
{
  namespace
  {
    using Json = nlohmann::ordered_json; // keeps the order of keys of doc/interface.md; non-finite numbers become null

    Json json(const ProblemSummary &problem)
    {
      return {{"dimension", problem.dimension},
              {"plane_state", problem.plane_state},
              {"bodies", problem.bodies},
              {"subdomains", problem.subdomains},
              {"primal_dofs", problem.primal_dofs},
              {"kernel_dimension", problem.kernel_dimension},
              {"cells", problem.cells},
              {"dual",
               {{"total", problem.dual.total},
                {"equality", problem.dual.equality},
                {"normal", problem.dual.normal},
                {"tangential", problem.dual.tangential}}},
              {"contact_candidates", problem.contact_candidates}};
    }

    Json json(const SolverSummary &solver)
    {
      return {{"algorithm", solver.algorithm},
              {"preconditioner", solver.preconditioner},
              {"dual_operator", solver.dual_operator},
              {"tolerance", solver.tolerance},
              {"hessian_multiplications", solver.hessian_multiplications},
              {"dual_setup_multiplications", solver.dual_setup_multiplications},
              {"preconditioner_applications", solver.preconditioner_applications},
              {"outer_iterations", solver.outer_iterations},
              {"cg_steps", solver.cg_steps},
              {"expansion_steps", solver.expansion_steps},
              {"proportioning_steps", solver.proportioning_steps},
              {"coulomb_iterations", solver.coulomb_iterations},
              {"fallbacks", solver.fallbacks},
              {"active_constraints", solver.active_constraints},
              {"dual_norm", solver.dual_norm}};
    }

    Json json(const ResidualSummary &residuals)
    {
      return {{"projected_gradient", residuals.projected_gradient},
              {"equality", residuals.equality},
              {"interface_jump", residuals.interface_jump},
              {"penetration", residuals.penetration},
              {"complementarity", residuals.complementarity},
              {"friction_bound", residuals.friction_bound},
              {"force_balance", residuals.force_balance},
              {"moment_balance", residuals.moment_balance},
              {"tension", residuals.tension},
              {"nodal_equilibrium", residuals.nodal_equilibrium}};
    }

    /// As many components as the dimension.
    template <std::size_t n>
    Json components(const std::array<double, n> &vector, const unsigned int count)
    {
      return std::vector<double>(vector.begin(), vector.begin() + count);
    }

    /// In the plane a single number, about z.
    Json moment(const std::array<double, 3> &m, const unsigned int dim)
    {
      return dim == 2 ? Json(m[2]) : Json(m);
    }

    /// @param noun key of the name.
    Json json(const std::vector<NamedResultant> &list, const char *noun, const unsigned int dim)
    {
      Json all = Json::array();
      for (const auto &one : list)
        {
          Json entry = {{noun, one.name}};
          if (noun != one.kind)
            entry["kind"] = one.kind;
          entry["force"]  = components(one.sum.force, dim);
          entry["moment"] = moment(one.sum.moment, dim);
          all.push_back(std::move(entry));
        }
      return all;
    }

    /// Adds the lists of loads, supports and foundations.
    Json with(Json entry, const ForceSummary &forces, const unsigned int dim)
    {
      entry["loads"]       = json(forces.loads, "load", dim);
      entry["supports"]    = json(forces.supports, "support", dim);
      entry["foundations"] = json(forces.foundations, "foundation", dim);
      return entry;
    }

    /// Adds the list of bolts, if there are any.
    Json with(Json entry, const std::vector<PretensionResult> &bolts)
    {
      for (const auto &bolt : bolts)
        entry["pretensions"].push_back({{"pretension", bolt.name},
                                        {"force", bolt.force},
                                        {"shortening", bolt.shortening},
                                        {"tightened", bolt.is_tightened}});
      return entry;
    }

    Json json(const std::vector<contact::PairResult> &contact, const unsigned int dim)
    {
      Json pairs = Json::array();
      for (const contact::PairResult &pair : contact)
        pairs.push_back(
          {{"pair", pair.pair},
           {"normal_force", pair.normal_force},
           {"tangential_force", pair.tangential_force},
           {"force", components(pair.on_slave.force, dim)},
           {"moment", moment(pair.on_slave.moment, dim)},
           {"moment_mismatch", moment(pair.moment_mismatch, dim)},
           {"max_pressure", pair.max_pressure},
           {"pressure_norm", pair.norm.pressure},
           {"traction_norm", pair.norm.tangential},
           {dim == 2 ? "contact_length" : "contact_area", pair.contact_length},
           {"contact_nodes", pair.contact_nodes},
           {"open_nodes", pair.open_nodes},
           {"stick_nodes", pair.stick_nodes},
           {"slip_nodes", pair.slip_nodes},
           {"algebraic_error",
            {{"pressure", pair.algebraic_error.pressure}, {"tangential", pair.algebraic_error.tangential}}}});
      return pairs;
    }

    /// Single points only; results along lines are in probes.csv.
    Json json(const std::vector<ProbeResult> &probes, const unsigned int dim)
    {
      Json list = Json::array();
      for (const ProbeResult &probe : probes)
        if (probe.is_point)
          list.push_back({{"probe", probe.name},
                          {"position", components(probe.points.front().position, dim)},
                          {"displacement", components(probe.points.front().displacement, dim)},
                          {"stress", components(probe.points.front().stress, 2 * dim)},
                          {"von_mises", probe.points.front().von_mises}});
      return list;
    }

    Json json(const Place &place, const unsigned int dim)
    {
      return {{"body", place.body}, {"position", components(place.position, dim)}};
    }

    Json json(const std::vector<StepSummary> &steps, const unsigned int dim)
    {
      Json list = Json::array();
      for (const StepSummary &step : steps)
        list.push_back(with(with({{"load_factor", step.load_factor},
                                  {"hessian_multiplications", step.hessian_multiplications},
                                  {"outer_iterations", step.outer_iterations},
                                  {"coulomb_iterations", step.coulomb_iterations},
                                  {"max_displacement", step.max_displacement},
                                  {"strain_energy", step.strain_energy},
                                  {"contact", json(step.contact, dim)},
                                  {"probes", json(step.probes, dim)}},
                                 step.forces,
                                 dim),
                            step.pretensions));
      return list;
    }

    Json json(const ResultSummary &results, const unsigned int dim)
    {
      Json all = with(with({{"max_displacement", results.max_displacement},
                            {"max_von_mises", results.max_von_mises},
                            {"max_von_mises_at", json(results.max_von_mises_at, dim)},
                            {"singular", results.singular.empty() ? Json() : Json(results.singular)},
                            {"strain_energy", results.strain_energy},
                            {"contact", json(results.contact, dim)},
                            {"probes", json(results.probes, dim)}},
                           results.forces,
                           dim),
                      results.pretensions);
      if (results.hoop_stress)
        {
          all["min_hoop_stress"] = (*results.hoop_stress)[0];
          all["max_hoop_stress"] = (*results.hoop_stress)[1];
        }
      return all;
    }

    Json json(const std::vector<ErrorBar> &bars)
    {
      Json list = Json::array();
      for (const ErrorBar &bar : bars)
        {
          list.push_back({{"quantity", bar.quantity},
                          {"value", bar.value},
                          {"error", bar.error ? Json(*bar.error) : Json()},
                          {"unit", bar.unit}});
          if (!bar.error)
            list.back()["reason"] = bar.reason;
          if (!bar.note.empty())
            list.back()["note"] = bar.note;
        }
      return list;
    }

    Json json(const std::vector<MeshRow> &meshes)
    {
      Json list = Json::array();
      for (const MeshRow &mesh : meshes)
        list.push_back({{"cells", mesh.cells},
                        {"unknowns", mesh.unknowns},
                        {"error", mesh.error},
                        {"error_energy", mesh.energy_error},
                        {"time", mesh.seconds}});
      return list;
    }

    Json json(const TimeSummary &time)
    {
      return {{"total", time.total},
              {"startup", time.startup},
              {"mesh", time.mesh},
              {"assembly", time.assembly},
              {"factorization", time.factorization},
              {"dual_setup", time.dual_setup},
              {"solve", time.solve},
              {"recovery", time.recovery},
              {"output", time.output},
              {"other", time.other}};
    }
  } // namespace

  std::string to_string(const RunStatus status)
  {
    switch (status)
      {
        case RunStatus::converged:
          return "converged";
        case RunStatus::not_converged:
          return "not converged";
        case RunStatus::no_equilibrium:
          return "no equilibrium";
        case RunStatus::unfinished:
          return "unfinished";
      }
    AssertThrow(false, dealii::ExcInternalError());
    return "";
  }

  std::string to_json(const Summary &summary)
  {
    const unsigned int dim  = summary.problem.dimension;
    Json               text = {{"case", summary.case_name},
                               {"version", summary.version},
                               {"ranks", summary.ranks},
                               {"status", to_string(summary.status)},
                               {"converged", summary.status == RunStatus::converged},
                               {"warnings", summary.warnings},
                               {"problem", json(summary.problem)},
                               {"solver", json(summary.solver)},
                               {"residuals", json(summary.residuals)},
                               {"error",
                                {{"estimate_energy_relative", summary.error.estimate_energy_relative},
                                 {"algebraic_relative", summary.error.algebraic_relative},
                                 {"largest_at", json(summary.error.largest_at, dim)},
                                 {"largest_part", summary.error.largest_part}}},
                               {"results", json(summary.results, dim)},
                               {"steps", json(summary.steps, dim)},
                               {"time_s", json(summary.time_s)},
                               {"memory_mb",
                                {{"peak_rank_max", summary.memory_mb.peak_rank_max}, {"peak_total", summary.memory_mb.peak_total}}}};
    if (!summary.error_bars.empty())
      text["error_bars"] = json(summary.error_bars);
    if (!summary.meshes.empty())
      text["meshes"] = json(summary.meshes);
    return text.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
  }

  void write_summary(const OutputDirectory &directory, const Summary &summary)
  {
    directory.write_from_root("summary.json", [&](std::ostream &out) { out << to_json(summary); });
  }
} // namespace slipstick::output
