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
    /// Description of the quantities that must be accurate.
    std::string what() const;

    void leave_out(std::vector<LeftOut<dim>> places);

    /// Adds one line per mesh.
    void add(const Run<dim> &steps, const output::Summary &summary);

    /// Finds the goals with estimates, and the reasons why others have none. Collective; bars are those of rank 0.
    void find_counted(const std::vector<output::ErrorBar> &bars);

    std::vector<GoalError> goals_of(const Run<dim> &steps) const;

    /// The largest relative change of the counted goals from the mesh before, which bars of coarse meshes may miss by far;
    /// nothing if one has no value there. On rank 0.
    std::optional<double> change_of_counted(const std::vector<output::ErrorBar> &bars);

    /// Marks the cells of the next mesh. @return why there is no next mesh although the accuracy is missed; empty: there is
    /// one, or none is needed.
    std::string why_to_stop(const Run<dim> &steps, const output::Summary &summary);

    /// Marks the cells of the next mesh. @return why there is none.
    std::string mark_next(const Run<dim> &steps, const output::Summary &summary);

    /// Errors in the energy norm; as long as a goal has no estimate, with an allowed error that is useful for reaching
    /// one.
    CellErrors errors_of(const Run<dim> &steps) const;

    const scene::Scene<dim>        &scene;
    const scene::AdaptivityOptions &options;
    const output::OutputDirectory  &directory;
    const Log                      &log;
    const Log                       quiet;
    const MPI_Comm                  comm;
    mesh::Refinement                refinement;
    contact::ContactOfMesh          contact; // on the mesh before
    std::vector<output::MeshRow>    rows;
    std::vector<LeftOut<dim>>       left_out;
    std::vector<std::string>        notes;
    std::vector<std::string>        counted;          // goals with an estimate ...
    std::vector<std::string>        unknown;          // ... and on rank 0 why the others have none
    std::string                     without_estimate; // a counted goal and the reason; empty: none
    unsigned int                    n_without = 0;    // consecutive meshes
    std::map<std::string, double>   values;           // on rank 0, of the mesh before
    double                          bar_over_error = 1;
    bool                            is_known       = false; // the error
    bool                            is_accurate    = false; // that error ...
    bool                            is_confirmed   = false; // ... and there is a mesh before to compare with
    bool                            reached        = false;
  };
} // namespace slipstick::app
