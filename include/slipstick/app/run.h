// The load steps of a scene on one mesh: solution, checks, output.
#pragma once

#include <slipstick/app/adaptivity.h>
#include <slipstick/app/goals.h>
#include <slipstick/app/step_results.h>

#include <memory>
#include <optional>
#include <set>

namespace slipstick::app
{
  /// Message about a motion that no support resists.
  std::string set_to_zero(const std::string &motion);

  /// Load steps and their results. Members are collective, except those that only return known values.
  template <int dim>
  class Run
  {
  public:
    /// @param wanted quantities that get error bars after the last load step; no value: none.
    /// @param refinement local refinement, if any.
    Run(const scene::Scene<dim>       &scene,
        const output::OutputDirectory &directory,
        const Log                     &log,
        const MPI_Comm                 comm,
        std::optional<RequestedBars>   wanted     = {},
        mesh::Refinement              *refinement = nullptr);

    /// The first load step will begin from the contact on another mesh.
    void start_from(contact::ContactOfMesh other)
    {
      solver.start_from(std::move(other));
    }

    /// See StepProblem.
    void assume_undriven()
    {
      solver.assume_undriven();
    }

    /// Whether motions that nothing resists were set to zero.
    bool has_still_motions() const
    {
      return !solver.unheld().empty();
    }

    /// The contact of the first load step. Collective.
    contact::ContactOfMesh contact_of_first_step() const;

    /// @return the summary, complete on rank 0 only.
    const output::Summary &solve_and_write(const bool resumes);

    /// Prints the results, at the end of a run.
    void print(const Log &to) const;

    /// Prints the warnings about input and solution.
    void print_warnings(const Log &to) const;

    /// Records in the summary whether a requested accuracy was reached.
    void finish(const std::vector<output::MeshRow> &meshes,
                const std::vector<std::string>     &notes,
                const std::string                  &missed);

    /// After a step without equilibrium: writes the results of the previous steps, with the status "no equilibrium".
    void write_without_equilibrium();

    /// Stresses of the last load step.
    const mechanics::StressResult &stress() const
    {
      return *last->stress;
    }
    const std::vector<GoalError> &goals() const
    {
      return errors;
    }
    const mesh::Mesh<dim> &mesh() const
    {
      return solver.mesh();
    }
    std::vector<LeftOut<dim>> point_forces() const;

    /// Whether this is a figure of a pair whose contact the mesh does not resolve in the last load step.
    bool is_unresolved(const std::string &goal) const;

    /// Marks the cells at these contacts. Collective. @return number of cells added.
    std::size_t mark_unresolved_contacts(mesh::Refinement &refinement) const;

    /// See contact_cells.h; with the contact nodes of the last load step. Collective.
    std::size_t mark_coarse_masters(const std::vector<std::string> &goals, mesh::Refinement &refinement) const;

  private:
    /// Takes over the results of an earlier run. @return its summary.
    output::Summary resume();

    /// Estimated remaining time of the run [s], assuming equal times per step; empty before the first step has ended.
    std::string time_left(const unsigned int step) const;

    bool prints() const;

    /// Sets the message for an interruption during load step @p step.
    void announce(const unsigned int step) const;

    /// Writes the tables of the steps so far, for the case that the run is interrupted later; less often if writing
    /// takes longer than solving.
    void keep(const unsigned int step, output::Summary summary);

    /// Adds warnings, one for each kind and pair.
    void warn(const Warnings &texts);

    /// @param so_far summary of the previous steps.
    output::Summary load_step(const unsigned int step, const output::Summary &so_far);

    /// Prints the checks of a solution and adds warnings about it. @return whether no declared contact is violated.
    bool warn_of_answer(const double t, const StepSolution &answer);

    /// Called after the last load step.
    void estimate_errors(const double t, output::Summary &summary);

    /// Writes tables and summary.json, which are consistent with each other whenever the run is interrupted.
    void write(const output::Summary &summary) const;

    void write_fields(const unsigned int step, const StepSolution &answer) const;

    /// Adds times, memory and warnings to @p summary.
    void describe_run(output::Summary &summary) const;

    const output::OutputDirectory   &directory;
    const Log                       &log;
    const MPI_Comm                   comm;
    std::optional<RequestedBars>     wanted; // quantities with error bars
    const bool                       refines;
    StageClock                       clock;
    StepSolver<dim>                  solver;
    const scene::Scene<dim>         &scene; // including the contact pairs found by the search
    mechanics::Probes<dim>           probes;
    std::unique_ptr<StepSolution>    last;   // of the last load step
    std::vector<GoalError>           errors; // of its quantities
    std::vector<output::ContactStep> contact_steps;
    std::vector<unsigned int>        unresolved_pairs; // in the last load step
    TotalSlip                        total_slip;
    double                           largest_force = 0; // of the load steps so far, on rank 0 [N]
    std::vector<std::string>         warnings;
    std::set<std::string>            warned_about;
    std::optional<output::Summary>   finished_steps;   // of all load steps that have ended
    unsigned int                     first_step   = 0; // of this process
    double                           steps_began  = 0; // [s]
    unsigned int                     kept_steps   = 0; // in the tables on the disk
    double                           kept_at      = 0; // when they were written [s]
    double                           writing_time = 0; // that this took [s]
  };
} // namespace slipstick::app
