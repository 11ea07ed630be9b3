#include <slipstick/app/command_line.h>
#include <slipstick/app/simulation.h>
#include <slipstick/scene/read.h>

#include <deal.II/base/mpi.h>

#include <Tpetra_Core.hpp>

#include <cstdlib>
#include <iostream>

// Present when the BLAS is OpenBLAS: its threads would fight with the ranks for the cores.
extern "C" void openblas_set_num_threads(int) __attribute__((weak));
// Present where CHOLMOD is built with OpenMP, whose regions ask for four threads whatever OMP_NUM_THREADS says.
extern "C" void omp_set_max_active_levels(int) __attribute__((weak));

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
  if (openblas_set_num_threads)
    openblas_set_num_threads(1);
  if (omp_set_max_active_levels)
    omp_set_max_active_levels(0);
  setenv("OMPI_MCA_ess_singleton_isolated", "1", 0); // Open MPI 4 starts a daemon where mpirun has not: 0.1 s
  dealii::Utilities::MPI::MPI_InitFinalize mpi(argc, argv, 1);
  // Kokkos, below Tpetra, has options of its own (and a --help): it gets to see the program's name only
  int                n_arguments = 1;
  char              *arguments[] = {argv[0], nullptr};
  char             **program     = arguments;
  Tpetra::ScopeGuard tpetra(&n_arguments, &program);
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
