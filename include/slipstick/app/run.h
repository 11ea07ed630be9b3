// The load steps of a scene on one mesh: solved, checked, written.
#pragma once

#include <slipstick/app/adaptivity.h>
#include <slipstick/app/goals.h>
#include <slipstick/app/step_results.h>

#include <memory>
#include <optional>
#include <set>

namespace slipstick::app
{
  /// What is said of motions that nothing resists.
  std::string set_to_zero(const std::string &motion);

  /// Load steps and their results. Members are collective, except those that only return known values.
  template <int dim>
  class Run
  {
  public:
    /// @param wanted error bars of these, after the last load step; with an empty list of all; nothing: none.
    /// @param refinement of single cells, if any.
    Run(const scene::Scene<dim>                &scene,
        const output::OutputDirectory          &directory,
        const Log                              &log,
        const MPI_Comm                          comm,
        std::optional<std::vector<std::string>> wanted     = {},
        mesh::Refinement                       *refinement = nullptr);

    /// @return the summary, which rank 0 knows completely.
    const output::Summary &solve_and_write(const bool resumes);

    /// What was found, at the end of a run.
    void print(const Log &to) const;

    /// Warnings about input and answer.
    void print_warnings(const Log &to) const;

    /// Says in the summary what became of an accuracy that was asked for.
    void finish(const std::vector<output::MeshRow> &meshes,
                const std::vector<std::string>     &notes,
                const std::string                  &missed);

    /// After a step without equilibrium: the results of the steps before it are kept and marked.
    void write_without_equilibrium();

    /// Of the last load step.
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

  private:
    /// Takes over what an earlier run has found. @return its summary.
    output::Summary resume();

    /// What is left of the run [s], if its steps take as long as those so far; none before the first one has ended.
    std::string time_left(const unsigned int step) const;

    bool prints() const;

    /// What is said when the user interrupts load step @p step.
    void announce(const unsigned int step) const;

    /// Writes the tables of the steps so far while others are still to come, for a run that does not live to see its end;
    /// less often where writing takes longer than solving.
    void keep(const unsigned int step, output::Summary summary);

    /// One warning for each kind and pair.
    void warn(const Warnings &texts);

    /// @param so_far of the steps before.
    output::Summary load_step(const unsigned int step, const output::Summary &so_far);

    /// Prints the checks of an answer and warns of what is found in it. @return whether its contacts are kept.
    bool warn_of_answer(const double t, const StepAnswer &answer);

    /// After the last load step.
    void estimate_errors(const double t, output::Summary &summary);

    void write_tables(const output::Summary &summary) const;

    void write_fields(const unsigned int step, const StepAnswer &answer) const;

    /// Puts times, memory and warnings into @p summary.
    void describe_run(output::Summary &summary) const;

    const output::OutputDirectory          &directory;
    const Log                              &log;
    const MPI_Comm                          comm;
    std::optional<std::vector<std::string>> wanted; // error bars
    const bool                              refines;
    StageClock                              clock;
    StepSolver<dim>                         solver;
    const scene::Scene<dim>                &scene; // with the contact pairs that are found
    mechanics::Probes<dim>                  probes;
    std::unique_ptr<StepAnswer>             last;   // load step
    std::vector<GoalError>                  errors; // of its figures
    std::vector<output::ContactStep>        contact_steps;
    TotalSlip                               total_slip;
    std::vector<std::string>                warnings;
    std::set<std::string>                   warned_about;
    std::optional<output::Summary>          finished_steps;   // of all load steps that have ended
    unsigned int                            first_step   = 0; // of this process
    double                                  steps_began  = 0; // [s]
    unsigned int                            kept_steps   = 0; // in the tables on the disk
    double                                  kept_at      = 0; // when they were written [s]
    double                                  writing_time = 0; // that this took [s]
  };
} // namespace slipstick::app
