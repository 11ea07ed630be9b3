#include <slipstick/base/memory.h>

#include <deal.II/base/exceptions.h>

#include <algorithm>
#include <fstream>
#include <limits>
#include <new>
#include <optional>
#include <string>

#include <sys/resource.h>
#include <unistd.h>

namespace slipstick
{
  bool is_out_of_memory(const std::exception &error)
  {
    return dynamic_cast<const std::bad_alloc *>(&error) ||
           dynamic_cast<const dealii::StandardExceptions::ExcOutOfMemory *>(&error);
  }

  InputError out_of_memory()
  {
    return {
      "out of memory",
      "use fewer Cells, Blocks, Refinements or Refine levels, or more memory (lift limits such as ulimit -v, more nodes)"};
  }

  namespace
  {
    /// First number of a file; nothing if there is none ("max": no limit).
    std::optional<double> number_in(const std::string &path)
    {
      std::ifstream file(path);
      double        number;
      return file >> number ? std::optional<double>(number) : std::nullopt;
    }

    /// The number behind @p key in a file of keys and numbers; 0 if there is none.
    double number_of(const std::string &key, const std::string &path)
    {
      std::ifstream file(path);
      std::string   word;
      double        number;
      while (file >> word >> number)
        if (word == key)
          return number;
      return 0;
    }

    /// Memory that the control group leaves [bytes]: its limit without what is used, except for cached files.
    double left_by_control_group()
    {
      struct Files
      {
        std::string limit, used, statistics, cached;
      };
      const std::string v2 = "/sys/fs/cgroup/memory.", v1 = "/sys/fs/cgroup/memory/memory.";
      double            left = std::numeric_limits<double>::infinity();
      for (const auto &files :
           {Files{v2 + "max", v2 + "current", v2 + "stat", "inactive_file"},
            Files{v1 + "limit_in_bytes", v1 + "usage_in_bytes", v1 + "stat", "total_inactive_file"}})
        if (const auto limit = number_in(files.limit))
          {
            const double used = number_in(files.used).value_or(0.) - number_of(files.cached, files.statistics);
            left              = std::min(left, std::max(0., *limit - std::max(0., used)));
          }
      return left;
    }

    /// Free memory of this machine in MB for the @p n_ranks processes of the run on it.
    double free_memory_mb(const unsigned int n_ranks)
    {
      double        free = std::numeric_limits<double>::infinity();
      std::ifstream info("/proc/meminfo");
      std::string   word;
      double        kilobytes;
      while (info >> word)
        if (word == "MemAvailable:" && info >> kilobytes)
          free = kilobytes / 1024;
      free = std::min(free, left_by_control_group() / 1048576);
      rlimit limit;
      if (getrlimit(RLIMIT_AS, &limit) == 0 && limit.rlim_cur != RLIM_INFINITY)
        {
          std::ifstream size("/proc/self/statm"); // first number: pages of the address space
          double        pages = 0;
          size >> pages;
          const double left = limit.rlim_cur - pages * sysconf(_SC_PAGESIZE);
          free              = std::min(free, n_ranks * (std::max(0., left) / 1048576.));
        }
      return free;
    }
  } // namespace

  double share_of_free_memory_mb(const MPI_Comm comm)
  {
    MPI_Comm machine;
    MPI_Comm_split_type(comm, MPI_COMM_TYPE_SHARED, 0, MPI_INFO_NULL, &machine);
    int n_ranks;
    MPI_Comm_size(machine, &n_ranks);
    MPI_Comm_free(&machine);
    return free_memory_mb(n_ranks) / n_ranks;
  }
} // namespace slipstick
