// summary.json: counts and numerical results of a run. Keys and units: doc/interface.md.
#pragma once

#include <slipstick/contact/result.h>
#include <slipstick/output/directory.h>

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace slipstick::output
{
  enum class RunStatus
  {
    converged,
    not_converged,
    no_equilibrium,
    unfinished // further load steps follow; the state left by an interrupted run
  };

  /// "converged", "not converged", "no equilibrium", "unfinished"
  std::string to_string(const RunStatus status);

  struct DualSummary
  {
    std::uint64_t total      = 0;
    std::uint64_t equality   = 0; // gluing and prescribed displacements
    std::uint64_t normal     = 0;
    std::uint64_t tangential = 0;
  };

  struct ProblemSummary
  {
    unsigned int  dimension = 2;
    std::string   plane_state;
    unsigned int  bodies           = 0;
    unsigned int  subdomains       = 0;
    std::uint64_t primal_dofs      = 0; // sum over the torn subdomains
    std::uint64_t kernel_dimension = 0;
    std::uint64_t cells            = 0;
    DualSummary   dual;
    std::uint64_t contact_candidates = 0; // slave nodes that may come into contact
  };

  struct SolverSummary
  {
    std::string   algorithm;
    std::string   preconditioner;
    std::string   dual_operator;                   // "explicit", "implicit"
    double        tolerance                   = 0; // relative, see Solver/Tolerance
    std::uint64_t hessian_multiplications     = 0; // after set-up
    std::uint64_t dual_setup_multiplications  = 0; // e.g. for the norm estimate
    std::uint64_t preconditioner_applications = 0;
    unsigned int  outer_iterations            = 0;
    std::uint64_t cg_steps                    = 0;
    std::uint64_t expansion_steps             = 0;
    std::uint64_t proportioning_steps         = 0;
    unsigned int  coulomb_iterations          = 0;
    unsigned int  fallbacks                   = 0;
    std::uint64_t active_constraints          = 0; // inequality multipliers at a bound
    double        dual_norm                   = 0; // estimate of |PFP|
  };

  /// Relative residuals of the stopping test, and checks of the recovered displacement.
  struct ResidualSummary
  {
    double projected_gradient = 0;
    double equality           = 0;
    double interface_jump     = 0;
    double penetration        = 0;
    double complementarity    = 0;
    double friction_bound     = 0;
    double force_balance      = 0;
    double moment_balance     = 0;
    double tension            = 0; // tensile contact forces
    double nodal_equilibrium  = 0;
  };

  /// A place in a body.
  struct Place
  {
    std::string           body;
    std::array<double, 3> position{{0, 0, 0}}; // reference configuration [mm]
  };

  struct ErrorSummary
  {
    double estimate_energy_relative = 0; // discretisation
    double algebraic_relative       = 0;
    Place  largest_at;       // centre of the cell with the largest part of the discretisation error
    double largest_part = 0; // part of the squared error [-]
  };

  /// Result at one point of a probe.
  struct ProbeValues
  {
    double                distance = 0;            // from the start of the probe [mm]
    std::array<double, 3> position{{0, 0, 0}};     // reference configuration [mm]
    std::array<double, 3> displacement{{0, 0, 0}}; // [mm]
    std::array<double, 6> stress{};                // xx, yy, xy, zz, in space xz, yz [MPa]
    double                von_mises = 0;           // [MPa]
  };

  struct ProbeResult
  {
    std::string              name;
    bool                     is_point = true; // otherwise a line
    std::vector<ProbeValues> points;
  };

  /// Force and moment of one load, support or foundation on the bodies.
  struct NamedResultant
  {
    std::string name;
    std::string kind; // "traction", "body force", "point load", "support", "foundation"
    Resultant   sum;
  };

  /// Lists in the order of the .prm.
  struct ForceSummary
  {
    std::vector<NamedResultant> loads, supports, foundations;
  };

  /// A pretensioned bolt, or one whose length is kept.
  struct PretensionResult
  {
    std::string name;
    double      force        = 0;     // tension [N]
    double      shortening   = 0;     // of the bolt relative to its force-free length [mm]
    bool        is_tightened = false; // the force is prescribed in this step
  };

  struct ResultSummary
  {
    double                   max_displacement = 0; // [mm]
    double                   max_von_mises    = 0; // [MPa]
    Place                    max_von_mises_at;
    std::string              singular; // why the stress there is infinite: "a re-entrant corner", ..; empty: finite
    std::vector<ProbeResult> probes;
    double                   strain_energy = 0;       // [N mm]
    std::optional<std::array<double, 2>> hoop_stress; // smallest and largest, of bodies of revolution [MPa]
    std::vector<contact::PairResult>     contact;
    ForceSummary                         forces;
    std::vector<PretensionResult>        pretensions;
  };

  /// Wall time of rank 0, including waiting for other ranks [s]. The stages add up to the total.
  struct TimeSummary
  {
    double total         = 0; // since the process was started
    double startup       = 0; // libraries, MPI, reading of the scene
    double mesh          = 0;
    double assembly      = 0;
    double factorization = 0;
    double dual_setup    = 0;
    double solve         = 0;
    double recovery      = 0;
    double output        = 0;
    double other         = 0; // between the stages
  };

  /// Resident memory [MB].
  struct MemorySummary
  {
    double peak_rank_max = 0;
    double peak_total    = 0;
  };

  /// One load step.
  struct StepSummary
  {
    double                           load_factor             = 1;
    std::uint64_t                    hessian_multiplications = 0;
    unsigned int                     outer_iterations        = 0;
    unsigned int                     coulomb_iterations      = 0;
    double                           max_displacement        = 0; // [mm]
    double                           strain_energy           = 0; // [N mm]
    std::vector<contact::PairResult> contact;
    ForceSummary                     forces;
    std::vector<ProbeResult>         probes;
    std::vector<PretensionResult>    pretensions;
  };

  /// A result quantity with the estimate of its discretisation error.
  struct ErrorBar
  {
    std::string           quantity; // as in Goal: "max_displacement", "PAIR.max_pressure", ..
    std::string           unit;
    double                value = 0;
    std::optional<double> error;  // in the same unit; if missing: see `reason`
    std::string           reason; // why there is no estimate
    std::string           note;   // what the quantity covers, if its name does not say it
  };

  /// One mesh of an adaptive run.
  struct MeshRow
  {
    std::uint64_t cells = 0, unknowns = 0;
    double        error        = 0; // relative: of the energy norm, or the largest of the goals
    double        energy_error = 0; // relative, in the energy norm
    double        seconds      = 0; // since the program was started
  };

  /// Counts are summed over the load steps, residuals are the worst of all steps, results are those of the last step.
  struct Summary
  {
    std::string     case_name;
    std::string     version;
    unsigned int    ranks  = 1;
    RunStatus       status        = RunStatus::not_converged;
    bool            is_inaccurate = false; // every mesh was solved, but the accuracy asked for is not reached
    ProblemSummary  problem;
    SolverSummary   solver;
    ResidualSummary residuals;
    ErrorSummary    error;
    ResultSummary   results;
    TimeSummary     time_s;
    MemorySummary   memory_mb;

    std::vector<StepSummary> steps;
    std::vector<std::string> warnings; // about the input or the solution

    std::vector<ErrorBar> error_bars; // of the last load step, if requested
    std::vector<MeshRow>  meshes;     // if meshes are refined
  };

  /// The text of summary.json. Numbers that are not finite become null, invalid UTF-8 becomes U+FFFD.
  std::string to_json(const Summary &summary);

  /// Writes summary.json from rank 0, whose @p summary is used. Collective.
  void write_summary(const OutputDirectory &directory, const Summary &summary);
} // namespace slipstick::output
