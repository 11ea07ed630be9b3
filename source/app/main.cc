#include <slipstick/app/command_line.h>
#include <slipstick/app/simulation.h>
#include <slipstick/scene/read.h>
#include <slipstick/tfeti/process.h>

#include <deal.II/base/mpi.h>

#include <iostream>

namespace
{
  using namespace slipstick;

  int run_program(int argc, char **argv, const MPI_Comm comm)
  {
    const bool prints = dealii::Utilities::MPI::this_mpi_process(comm) == 0;
    const auto report = [prints](const std::exception &error, const ExitStatus status) {
      if (prints)
        std::cerr << "error: " << error.what() << std::endl;
      return static_cast<int>(status);
    };
    // these errors come to all ranks alike, see base/collective.h
    try
      {
        const auto command_line = app::parse_command_line(argc, argv);
        if (command_line.message || command_line.list_parameters)
          {
            if (prints && command_line.message)
              std::cout << *command_line.message << std::flush;
            else if (prints)
              scene::list_parameters(std::cout, *command_line.list_parameters);
            return static_cast<int>(ExitStatus::converged);
          }
        const auto scene = scene::read_scene(command_line.case_file, command_line.overrides);
        const Log  log(comm,
                      command_line.quiet                           ? Verbosity::quiet
                       : command_line.verbose || command_line.check ? Verbosity::verbose
                                                                    : Verbosity::normal);
        if (command_line.check)
          {
            app::check_scene(scene, log, comm);
            return static_cast<int>(ExitStatus::converged);
          }
        return static_cast<int>(app::run(scene, command_line.output_directory, log, comm));
      }
    catch (const InputError &error)
      {
        return report(error, ExitStatus::bad_input);
      }
    catch (const NoEquilibrium &error)
      {
        return report(error, ExitStatus::no_equilibrium);
      }
    catch (const NumericalError &error)
      {
        return report(error, ExitStatus::internal_error);
      }
  }
} // namespace

int main(int argc, char **argv)
{
  tfeti::Process process;
  try
    {
      return run_program(argc, argv, MPI_COMM_WORLD);
    }
  catch (const std::exception &error)
    {
      // perhaps on this rank alone: the others must not be left waiting
      std::cerr << "internal error: " << error.what()
                << "\n  remedy: this is a bug of slipstick, please report it with the .prm" << std::endl;
      MPI_Abort(MPI_COMM_WORLD, static_cast<int>(ExitStatus::internal_error));
    }
  return static_cast<int>(ExitStatus::internal_error);
}
