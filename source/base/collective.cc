#include <slipstick/base/collective.h>
#include <slipstick/base/memory.h>

#include <deal.II/base/mpi.h>

#include <new>

namespace slipstick
{
  namespace
  {
    enum class Kind
    {
      none,
      input,
      no_equilibrium,
      numerical,
      other
    };

    struct Report
    {
      Kind        kind = Kind::none;
      std::string text;
    };

    Report run(const std::function<void()> &stage)
    {
      try
        {
          stage();
        }
      catch (const InputError &error)
        {
          return {Kind::input, error.what()};
        }
      catch (const NoEquilibrium &error)
        {
          return {Kind::no_equilibrium, error.what()};
        }
      catch (const NumericalError &error)
        {
          return {Kind::numerical, error.what()};
        }
      catch (const std::exception &error)
        {
          if (is_out_of_memory(error))
            return {Kind::input, out_of_memory().what()};
          return {Kind::other, error.what()};
        }
      return {};
    }
  } // namespace

  void collectively(const MPI_Comm comm, const std::function<void()> &stage)
  {
    const Report       mine    = run(stage);
    const unsigned int n_ranks = dealii::Utilities::MPI::n_mpi_processes(comm);
    const unsigned int rank    = dealii::Utilities::MPI::this_mpi_process(comm);
    const unsigned int first   = dealii::Utilities::MPI::min(mine.kind == Kind::none ? n_ranks : rank, comm);
    if (first == n_ranks)
      return;

    const int  kind = dealii::Utilities::MPI::broadcast(comm, static_cast<int>(mine.kind), first);
    const auto text = dealii::Utilities::MPI::broadcast(comm, mine.text, first);
    switch (static_cast<Kind>(kind))
      {
        case Kind::input:
          throw InputError(Error::Ready{}, text);
        case Kind::no_equilibrium:
          throw NoEquilibrium(Error::Ready{}, text);
        case Kind::numerical:
          throw NumericalError(Error::Ready{}, text);
        default:
          throw std::runtime_error(text);
      }
  }
} // namespace slipstick
