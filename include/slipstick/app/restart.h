// Files from which a run goes on after its last finished load step.
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
  /// Of contact nodes, by pair and node: the slip of all load steps so far [mm].
  using TotalSlip = std::map<std::pair<unsigned int, mechanics::NodeKey>, double>;

  /// What one rank knows after a load step.
  struct RunState
  {
    StepState                        solver;
    output::Summary                  summary;       // of the steps so far
    std::vector<output::ContactStep> contact_steps; // rank 0
    TotalSlip                        total_slip;    // rank 0
    std::vector<std::string>         warnings;
    std::set<std::string>            warned_about;
  };

  /// Writes restart_NNN_RRRR.bin of every rank (NNN: finished steps) and then restart.bin, which names them; what stood there
  /// before goes last. Collective.
  /// @throws InputError when the disk does not take it.
  void write_restart(const output::OutputDirectory &directory,
                     const scene::Scene<2>         &scene,
                     const RunState                &state,
                     const MPI_Comm                 comm);

  /// @throws InputError when there is nothing to resume, or when scene, mesh files, version or number of ranks are others than
  /// those of the run. Load factors may differ after the finished steps. Collective.
  RunState read_restart(const output::OutputDirectory &directory, const scene::Scene<2> &scene, const MPI_Comm comm);

  /// Of a run that has ended. Collective.
  void remove_restart(const output::OutputDirectory &directory, const MPI_Comm comm);
} // namespace slipstick::app
