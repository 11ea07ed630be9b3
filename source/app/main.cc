#include <slipstick/app/command_line.h>
#include <slipstick/app/interruption.h>
#include <slipstick/app/new_scene.h>
#include <slipstick/app/simulation.h>
#include <slipstick/base/collective.h>
#include <slipstick/base/memory.h>
#include <slipstick/base/printable.h>
#include <slipstick/mesh/size_check.h>
#include <slipstick/scene/read.h>
#include <slipstick/tfeti/process.h>

#include <deal.II/base/mpi.h>

#include <algorithm>
#include <array>
#include <csignal>
#include <cstdlib>
#include <cstring>
#include <iostream>
#include <new>
#include <vector>

#include <sys/mman.h>
#include <sys/resource.h>
#include <unistd.h>

extern "C" void dpotrf_(const char *, const int *, double *, const int *, int *);

namespace
{
  using namespace slipstick;

  // OpenBLAS allocates a buffer of 128 MB at its first factorisation (newer versions already when loaded) and retries
  // forever if the allocation fails.
  constexpr std::size_t least_free_space = 256u << 20; // bytes of address space: the buffer and its surroundings

  /// Whether the address space is limited (ulimit -v); throws if too little of it is free.
  bool has_limited_address_space()
  {
    rlimit limit;
    if (getrlimit(RLIMIT_AS, &limit) != 0 || limit.rlim_cur == RLIM_INFINITY)
      return false;
    void *const space = mmap(nullptr, least_free_space, PROT_NONE, MAP_PRIVATE | MAP_ANONYMOUS | MAP_NORESERVE, -1, 0);
    if (space == MAP_FAILED)
      throw InputError("the address space is limited to " + std::to_string(limit.rlim_cur >> 20) +
                         " MB per process, of which less than " + std::to_string(least_free_space >> 20) +
                         " MB are left at the start",
                       "raise or lift the limit: ulimit -v unlimited");
    munmap(space, least_free_space);
    return true;
  }

  /// If the address space is limited: allocates the buffer before anything else.
  void check_address_space()
  {
    if (!has_limited_address_space())
      return;
    const int n = 1; // small matrix products do not use the buffer
    double    a = 1;
    int       info;
    dpotrf_("L", &n, &a, &n, &info);
  }

  /// Runs before the constructors of the libraries. Neither streams nor MPI are available yet: every rank ends, the
  /// first one prints.
  void check_address_space_before_libraries()
  {
    try
      {
        has_limited_address_space();
      }
    catch (const InputError &error)
      {
        const auto is_other = [](const char *variable) { // rank variables of Open MPI, PMIx, MPICH, Slurm
          const char *const rank = std::getenv(variable);
          return rank && std::strcmp(rank, "0") != 0;
        };
        constexpr std::array<const char *, 4> ranks = {
          {"OMPI_COMM_WORLD_RANK", "PMIX_RANK", "PMI_RANK", "SLURM_PROCID"}};
        const std::string text = std::string("error: ") + error.what() + "\n";
        const bool        told = std::any_of(ranks.begin(), ranks.end(), is_other) ||
                          ::write(STDERR_FILENO, text.data(), text.size()) == static_cast<ssize_t>(text.size());
        ::_exit(told ? static_cast<int>(ExitStatus::bad_input) : static_cast<int>(ExitStatus::internal_error));
      }
  }
  [[gnu::section(".preinit_array"), gnu::used]] void (*before_libraries)() = check_address_space_before_libraries;

  template <int dim>
  ExitStatus run_scene(const app::CommandLine &command_line, const MPI_Comm comm)
  {
    scene::AdaptivityOptions adaptivity;
    const auto scene = scene::read_scene<dim>(command_line.case_file, command_line.overrides, &adaptivity);
    const Log  log(comm,
                  command_line.quiet                           ? Verbosity::quiet
                   : command_line.verbose || command_line.check ? Verbosity::verbose
                                                                : Verbosity::normal);
    mesh::check_size(scene, command_line.force, comm);
    if (command_line.check)
      {
        app::check_scene(scene, command_line.picture, log, comm);
        return ExitStatus::converged;
      }
    return app::run(scene, adaptivity, command_line.output_directory, command_line.resume, log, comm);
  }

  /// With --set Dimension=3 the parameters in space.
  void list_parameters(const app::CommandLine &command_line)
  {
    const auto &set = command_line.overrides;
    if (std::find(set.begin(), set.end(), "Dimension=3") == set.end())
      scene::list_parameters<2>(std::cout, *command_line.list_parameters);
    else
      scene::list_parameters<3>(std::cout, *command_line.list_parameters);
  }

  int run_program(int argc, char **argv, const MPI_Comm comm)
  {
    const bool prints = dealii::Utilities::MPI::this_mpi_process(comm) == 0;
    const auto report = [prints](const std::exception &error, const ExitStatus status) {
      app::do_not_tell_when_interrupted(); // mpirun may end this rank by a signal when another one has ended
      if (prints)
        std::cerr << "error: " + for_terminal(error.what()) + '\n' << std::flush; // in one piece for mpirun
      return static_cast<int>(status);
    };
    // these errors are thrown on all ranks, see base/collective.h
    try
      {
        collectively(comm, check_address_space);
        const auto command_line = app::parse_command_line(argc, argv);
        if (command_line.message || command_line.list_parameters)
          {
            collectively(comm, [&] {
              if (!prints)
                return;
              if (command_line.message)
                std::cout << *command_line.message;
              else
                list_parameters(command_line);
              if (!std::cout.flush())
                throw InputError("the text could not be written to standard output",
                                 "check where it is redirected to and whether there is space");
            });
            return static_cast<int>(ExitStatus::converged);
          }
        if (command_line.new_scene)
          {
            std::string told;
            collectively(comm, [&] {
              if (prints)
                told = app::write_new_scene(*command_line.new_scene);
            });
            if (prints)
              std::cout << told << std::flush;
            return static_cast<int>(ExitStatus::converged);
          }
        return static_cast<int>(scene::read_dimension(command_line.case_file, command_line.overrides) == 3
                                  ? run_scene<3>(command_line, comm)
                                  : run_scene<2>(command_line, comm));
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
  std::signal(SIGXFSZ, SIG_IGN); // a limit on the file size is reported like a full disk
  tfeti::Process process;
  try
    {
      return run_program(argc, argv, MPI_COMM_WORLD);
    }
  catch (const std::exception &error)
    {
      if (is_out_of_memory(error))
        {
          std::cerr << std::string("error: ") + out_of_memory().what() + '\n' << std::flush;
          if (dealii::Utilities::MPI::n_mpi_processes(MPI_COMM_WORLD) > 1) // the error may be on this rank only
            MPI_Abort(MPI_COMM_WORLD, static_cast<int>(ExitStatus::bad_input));
          return static_cast<int>(ExitStatus::bad_input);
        }
      // the error may be on this rank only; the others must not be left waiting
      std::cerr << "internal error: " + for_terminal(error.what()) +
                     "\n  remedy: this is a bug of slipstick, please report it with the .prm\n"
                << std::flush;
      MPI_Abort(MPI_COMM_WORLD, static_cast<int>(ExitStatus::internal_error));
    }
  return static_cast<int>(ExitStatus::internal_error);
}
