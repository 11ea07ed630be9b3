#include <slipstick/base/memory.h>

#include <deal.II/base/exceptions.h>

#include <algorithm>
#include <fstream>
#include <limits>
#include <new>
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

  double free_memory_mb(const unsigned int n_ranks)
  {
    double        free = std::numeric_limits<double>::infinity();
    std::ifstream info("/proc/meminfo");
    std::string   word;
    double        kilobytes;
    while (info >> word)
      if (word == "MemAvailable:" && info >> kilobytes)
        free = kilobytes / 1024;
    for (const std::string group : {"/sys/fs/cgroup/memory.max", "/sys/fs/cgroup/memory/memory.limit_in_bytes"})
      {
        std::ifstream limit(group);
        double        bytes;
        if (limit >> bytes) // "max" means no limit
          free = std::min(free, bytes / 1048576);
      }
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
