// Adaptive mesh refinement until an accuracy is reached.
#pragma once

#include <slipstick/app/run.h>

#include <map>
#include <optional>
#include <string>
#include <vector>

namespace slipstick::app
{
  /// The loop solve, estimate, mark, refine.
  template <int dim>
  class RefiningRun
  {
  public:
    /// @param options include the accuracy to be reached.
    RefiningRun(const scene::Scene<dim>        &scene,
                const scene::AdaptivityOptions &options,
                const output::OutputDirectory  &directory,
                const Log                      &log,
                const MPI_Comm                  comm);

    /// @param steps returns the run on the last mesh. Collective.
    ExitStatus run(std::optional<Run<dim>> &steps);

  private:
    /// Description of the quantities to which the accuracy applies.
    std::string what() const;

    void leave_out(std::vector<LeftOut<dim>> places);

    /// Adds one line per mesh.
    void add(const Run<dim> &steps, const output::Summary &summary);

    /// Finds the goals with estimates, and the reasons why others have none. Collective; bars are those of rank 0.
    void find_counted(const std::vector<output::ErrorBar> &bars, const output::ResultSummary &results);

    /// Finds what the errors of the counted goals are compared with.
    void find_scales(const std::vector<output::ErrorBar> &bars, const output::ResultSummary &results);

    std::vector<GoalError> goals_of(const Run<dim> &steps) const;

    /// The largest relative change of the counted goals from the previous mesh, which bars on coarse meshes may
    /// underestimate by far; nothing if a goal has no value on that mesh. On rank 0.
    std::optional<double> change_of_counted(const std::vector<output::ErrorBar> &bars);

    /// Marks the cells to be refined for the next mesh. @return why there is no next mesh although the accuracy has not
    /// been reached; empty: there is one, or none is needed.
    std::string why_to_stop(const Run<dim> &steps, const output::Summary &summary);

    /// What to ask for in place of a largest stress that meshes show to be infinite; empty: none is. Collective.
    std::string remedy_for_stress(const Run<dim> &steps, const output::Summary &summary) const;

    /// Marks the cells to be refined for the next mesh. @return why there is no next mesh; empty: there is one.
    std::string mark_next(const Run<dim> &steps, const output::Summary &summary);

    /// Errors in the energy norm. With goals the allowed error is 0, so that cells are marked until the goals have
    /// estimates.
    CellErrors errors_of(const Run<dim> &steps) const;

    const scene::Scene<dim>        &scene;
    const scene::AdaptivityOptions &options;
    const output::OutputDirectory  &directory;
    const Log                      &log;
    const Log                       quiet;
    const MPI_Comm                  comm;
    mesh::Refinement                refinement;
    contact::ContactOfMesh          contact;             // on the previous mesh
    bool                            is_undriven = false; // whether motions that nothing resists were found on the first
    std::vector<output::MeshRow>    rows;
    std::vector<LeftOut<dim>>       left_out;
    std::vector<std::string>        notes;
    std::vector<std::string>        counted;  // goals with an estimate ...
    std::vector<std::string>        unknown;  // ... and on rank 0 why the others have none
    std::map<std::string, double>   scales;   // on rank 0: magnitudes of the counted goals, or of what is 0 beside them
    std::map<std::string, std::string> zeros; // on rank 0: counted goals that are 0 within their errors, in words
    std::string                        without_estimate;   // a counted goal and the reason; empty: none
    bool                               may_settle = false; // values without an estimate grow little or not at all
    unsigned int                       n_without  = 0;     // consecutive meshes
    std::map<std::string, std::vector<double>> values;     // on rank 0, of the goals with bars on all meshes so far
    double                                     bar_over_error = 1;
    bool                                       is_known       = false; // the error
    bool                                       is_accurate    = false; // that error ...
    bool                                       is_confirmed = false; // ... and there is a previous mesh to compare with
    bool                                       reached      = false;
  };
} // namespace slipstick::app
