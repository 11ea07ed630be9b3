// Meshes that are refined until an accuracy is reached.
#pragma once

#include <slipstick/app/run.h>

namespace slipstick::app
{
  /// Solve, estimate, mark, refine.
  template <int dim>
  class RefiningRun
  {
  public:
    /// @param options with an accuracy to be reached.
    RefiningRun(const scene::Scene<dim>        &scene,
                const scene::AdaptivityOptions &options,
                const output::OutputDirectory  &directory,
                const Log                      &log,
                const MPI_Comm                  comm);

    /// @param steps of the mesh solved last. Collective.
    ExitStatus run(std::optional<Run<dim>> &steps);

  private:
    /// What is to be accurate.
    std::string what() const;

    void leave_out(std::vector<LeftOut<dim>> places);

    /// One line a mesh.
    void add(const Run<dim> &steps, const output::Summary &summary);

    /// Which goals have estimates, and why the others have none. Collective; bars are known on rank 0.
    void find_counted(const std::vector<output::ErrorBar> &bars);

    std::vector<GoalError> goals_of(const Run<dim> &steps) const;

    /// Marks the cells of the next mesh. @return why there is none; empty: there is one, or none is needed.
    std::string why_to_stop(const Run<dim> &steps, const output::Summary &summary);

    /// In the energy norm; on the way to a goal without an estimate as much as is useful.
    CellErrors errors_of(const Run<dim> &steps) const;

    const scene::Scene<dim>        &scene;
    const scene::AdaptivityOptions &options;
    const output::OutputDirectory  &directory;
    const Log                      &log;
    const Log                       quiet;
    const MPI_Comm                  comm;
    mesh::Refinement                refinement;
    std::vector<output::MeshRow>    rows;
    std::vector<LeftOut<dim>>       left_out;
    std::vector<std::string>        notes;
    std::vector<std::string>        counted;          // goals ...
    std::vector<std::string>        unknown;          // ... and on rank 0 what the others lack
    std::string                     without_estimate; // a goal that counts, and why; empty: there is none
    unsigned int                    n_without = 0;    // meshes, one after another
    bool                            reached = false, is_known = false;
  };
} // namespace slipstick::app
