// Restart files, from which a run continues after its last completed load step.
#pragma once

#include <slipstick/app/step_state.h>
#include <slipstick/interface/interface_node.h>
#include <slipstick/output/contact_line.h>
#include <slipstick/output/summary.h>
#include <slipstick/scene/scene.h>

#include <map>
#include <set>

namespace slipstick::app
{
  /// For contact nodes, by pair and node: slip of all load steps so far; a vector in space, in the plane only the first
  /// component is used [mm].
  using TotalSlip = std::map<std::pair<unsigned int, mechanics::NodeKey>, std::array<double, 3>>;

  /// State of one rank after a load step.
  struct RunState
  {
    StepState                        solver;
    output::Summary                  summary;           // of the steps so far
    std::vector<output::ContactStep> contact_steps;     // rank 0
    TotalSlip                        total_slip;        // rank 0
    double                           largest_force = 0; // of a contact pair, in all steps so far [N]
    std::vector<std::string>         warnings;
    std::set<std::string>            warned_about;
  };

  /// Writes restart_NNN_RRRR.bin of every rank (NNN: completed steps) and then restart.bin, which names them; the
  /// previous files are removed last. Collective.
  /// @throws InputError if they cannot be written.
  template <int dim>
  void write_restart(const output::OutputDirectory &directory,
                     const scene::Scene<dim>       &scene,
                     const RunState                &state,
                     const MPI_Comm                 comm);

  /// @throws InputError if there is nothing to resume, or if scene, files of meshes and surfaces, version or number of ranks differ from
  /// those of the run. Load factors may differ after the completed steps. Collective.
  template <int dim>
  RunState read_restart(const output::OutputDirectory &directory, const scene::Scene<dim> &scene, const MPI_Comm comm);

  /// Removes the restart files of a finished run. Collective.
  void remove_restart(const output::OutputDirectory &directory, const MPI_Comm comm);
} // namespace slipstick::app
