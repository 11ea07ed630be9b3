#include <slipstick/output/summary.h>

#include "temporary_directory.h"

#include <nlohmann/json.hpp>

#include <cmath>
#include <limits>
#include <vector>

using namespace slipstick;
using namespace slipstick::output;

namespace
{
  using SummaryFile = TemporaryDirectory;
  using Json        = nlohmann::ordered_json;

  std::vector<std::string> keys(const Json &object)
  {
    std::vector<std::string> names;
    for (const auto &item : object.items())
      names.push_back(item.key());
    return names;
  }

  using Keys = std::vector<std::string>;

  Json parsed(const Summary &summary)
  {
    return Json::parse(to_json(summary));
  }
} // namespace

TEST(Summary, sections_are_those_of_the_contract)
{
  EXPECT_EQ(keys(parsed(Summary())),
            Keys({"case",
                  "version",
                  "ranks",
                  "status",
                  "converged",
                  "warnings",
                  "problem",
                  "solver",
                  "residuals",
                  "error",
                  "results",
                  "steps",
                  "time_s",
                  "memory_mb"}));
}

TEST(Summary, problem_has_the_keys_of_the_contract)
{
  const Json problem = parsed(Summary())["problem"];
  EXPECT_EQ(keys(problem),
            Keys({"dimension",
                  "plane_state",
                  "bodies",
                  "subdomains",
                  "primal_dofs",
                  "kernel_dimension",
                  "cells",
                  "dual",
                  "contact_candidates"}));
  EXPECT_EQ(keys(problem["dual"]), Keys({"total", "equality", "normal", "tangential"}));
}

TEST(Summary, solver_has_the_keys_of_the_contract)
{
  EXPECT_EQ(keys(parsed(Summary())["solver"]),
            Keys({"algorithm",
                  "preconditioner",
                  "dual_operator",
                  "tolerance",
                  "hessian_multiplications",
                  "dual_setup_multiplications",
                  "preconditioner_applications",
                  "outer_iterations",
                  "cg_steps",
                  "expansion_steps",
                  "proportioning_steps",
                  "coulomb_iterations",
                  "fallbacks",
                  "active_constraints",
                  "dual_norm"}));
}

TEST(Summary, residuals_and_errors_have_the_keys_of_the_contract)
{
  EXPECT_EQ(keys(parsed(Summary())["residuals"]),
            Keys({"projected_gradient",
                  "equality",
                  "interface_jump",
                  "penetration",
                  "complementarity",
                  "friction_bound",
                  "force_balance",
                  "moment_balance",
                  "tension",
                  "nodal_equilibrium"}));
  EXPECT_EQ(keys(parsed(Summary())["error"]),
            Keys({"estimate_energy_relative", "algebraic_relative", "largest_at", "largest_part"}));
}

TEST(Summary, results_have_the_keys_of_the_contract)
{
  Summary summary;
  summary.results.contact.emplace_back();
  const Json results = parsed(summary)["results"];
  EXPECT_EQ(keys(results),
            Keys({"max_displacement",
                  "max_von_mises",
                  "max_von_mises_at",
                  "singular",
                  "strain_energy",
                  "contact",
                  "probes",
                  "loads",
                  "supports",
                  "foundations"}));
  EXPECT_EQ(keys(results["contact"][0]),
            Keys({"pair",
                  "normal_force",
                  "tangential_force",
                  "force",
                  "moment",
                  "moment_mismatch",
                  "max_pressure",
                  "pressure_norm",
                  "traction_norm",
                  "contact_length",
                  "contact_nodes",
                  "open_nodes",
                  "stick_nodes",
                  "slip_nodes",
                  "algebraic_error"}));
}

TEST(Summary, times_and_memory_have_the_keys_of_the_contract)
{
  EXPECT_EQ(
    keys(parsed(Summary())["time_s"]),
    Keys(
      {"total", "startup", "mesh", "assembly", "factorization", "dual_setup", "solve", "recovery", "output", "other"}));
  EXPECT_EQ(keys(parsed(Summary())["memory_mb"]), Keys({"peak_rank_max", "peak_total"}));
}

TEST(Summary, status_and_converged_agree)
{
  const std::vector<std::pair<RunStatus, std::string>> all = {{RunStatus::converged, "converged"},
                                                              {RunStatus::not_converged, "not converged"},
                                                              {RunStatus::no_equilibrium, "no equilibrium"}};
  for (const auto &[status, name] : all)
    {
      Summary summary;
      summary.status = status;
      EXPECT_EQ(parsed(summary)["status"], name);
      EXPECT_EQ(parsed(summary)["converged"], status == RunStatus::converged);
    }
}

TEST(Summary, no_contact_is_an_empty_list)
{
  EXPECT_TRUE(parsed(Summary())["results"]["contact"].is_array());
  EXPECT_TRUE(parsed(Summary())["results"]["contact"].empty());
}

TEST(Summary, numbers_read_back_exactly)
{
  Summary summary;
  summary.results.strain_energy          = 1. / 3;
  summary.solver.hessian_multiplications = 9007199254740993;
  EXPECT_EQ(parsed(summary)["results"]["strain_energy"].get<double>(), 1. / 3);
  EXPECT_EQ(parsed(summary)["solver"]["hessian_multiplications"].get<std::uint64_t>(), 9007199254740993u);
}

TEST(Summary, numbers_that_are_not_finite_become_null)
{
  Summary summary;
  summary.residuals.equality    = std::numeric_limits<double>::quiet_NaN();
  summary.results.max_von_mises = std::numeric_limits<double>::infinity();
  EXPECT_TRUE(parsed(summary)["residuals"]["equality"].is_null());
  EXPECT_TRUE(parsed(summary)["results"]["max_von_mises"].is_null());
}

TEST(Summary, names_in_latin_1_or_with_quotes_stay_valid)
{
  Summary summary;
  summary.case_name = "B\xfcgel \"A\"\n";
  EXPECT_EQ(parsed(summary)["case"], "B\xef\xbf\xbdgel \"A\"\n");
}

TEST_F(SummaryFile, rank_0_writes_the_text)
{
  const OutputDirectory directory(root, MPI_COMM_WORLD);
  Summary               summary;
  summary.case_name = is_root() ? "box" : "another rank's";
  write_summary(directory, summary);
  EXPECT_EQ(Json::parse(content(directory.path("summary.json")))["case"], "box");
}
