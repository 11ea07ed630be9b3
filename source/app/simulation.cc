#include <slipstick/app/refining_run.h>
#include <slipstick/app/simulation.h>
#include <slipstick/output/scene_picture.h>

#include <filesystem>
#include <optional>

namespace slipstick::app
{
  template <int dim>
  void check_scene(const scene::Scene<dim> &scene, const std::string &picture, const Log &log, const MPI_Comm comm)
  {
    StageClock      clock;
    StepSolver<dim> solver(scene, log, clock, comm);
    mechanics::Probes<dim>(scene, solver.mesh(), solver.spaces());
    solver.build();
    if (!solver.unheld().empty())
      log.line("warning: " + set_to_zero(solver.unheld()));
    log.line(std::string("the scene is complete: every subdomain has its rigid motions as kernel") +
             (solver.unheld().empty() ? ", every body is held by supports or contact" : ""));
    if (picture.empty())
      return;
    auto as_given = solver.discrete_scene();
    as_given.supports.resize(solver.n_given_supports());
    const std::filesystem::path   file(picture);
    const output::OutputDirectory directory(file.has_parent_path() ? file.parent_path().string() : ".", comm);
    output::write_scene_picture(directory, file.filename().string(), as_given, solver.mesh(), solver.spaces());
    log.line("picture of the scene: " + picture);
  }

  template <int dim>
  ExitStatus run(const scene::Scene<dim>        &scene,
                 const scene::AdaptivityOptions &adaptivity,
                 const std::string              &output_directory,
                 const bool                      resumes,
                 const Log                      &log,
                 const MPI_Comm                  comm)
  {
    if (resumes && adaptivity.refines())
      throw InputError("--resume: adaptive runs cannot be resumed",
                       "start it anew, without --resume, or give Accuracy without a percentage");
    const output::OutputDirectory directory(output_directory, comm);
    std::optional<Run<dim>>       steps;
    try
      {
        if (adaptivity.refines())
          return RefiningRun<dim>(scene, adaptivity, directory, log, comm).run(steps);
        std::optional<RequestedBars> wanted;
        if (adaptivity.error_bars)
          wanted = RequestedBars{true, {}};
        steps.emplace(scene, directory, log, comm, wanted);
        const bool converged = steps->solve_and_write(resumes).status == output::RunStatus::converged;
        steps->print(log);
        return converged ? ExitStatus::converged : ExitStatus::not_converged;
      }
    catch (const InputError &) // some faults show only in meshes and formulas
      {
        directory.remove_if_new();
        throw;
      }
    catch (const NoEquilibrium &) // on all ranks
      {
        if (steps)
          steps->write_without_equilibrium();
        throw;
      }
  }

  template void       check_scene(const scene::Scene<2> &, const std::string &, const Log &, const MPI_Comm);
  template void       check_scene(const scene::Scene<3> &, const std::string &, const Log &, const MPI_Comm);
  template ExitStatus run(const scene::Scene<2> &,
                          const scene::AdaptivityOptions &,
                          const std::string &,
                          const bool,
                          const Log &,
                          const MPI_Comm);
  template ExitStatus run(const scene::Scene<3> &,
                          const scene::AdaptivityOptions &,
                          const std::string &,
                          const bool,
                          const Log &,
                          const MPI_Comm);
} // namespace slipstick::app
