#include <slipstick/base/log.h>

#include <deal.II/base/exceptions.h>
#include <deal.II/base/mpi.h>

#include <algorithm>
#include <cstdarg>
#include <cstdio>
#include <ctime>
#include <fstream>
#include <iostream>
#include <sstream>

#include <sys/resource.h>
#include <unistd.h>

namespace slipstick
{
  namespace
  {
    constexpr std::size_t width_of_stages = 13; // of the name of the stage at the start of a line
  }

  Log::Log(const MPI_Comm comm, const Verbosity verbosity)
    : prints(dealii::Utilities::MPI::this_mpi_process(comm) == 0)
    , verbosity(verbosity)
  {}

  void Log::line(const std::string &text) const
  {
    if (prints && verbosity != Verbosity::quiet)
      std::cout << text << std::endl;
  }

  void Log::remark(const std::string &text) const
  {
    line(std::string(width_of_stages, ' ') + text);
  }

  void Log::detail(const std::string &text) const
  {
    if (prints && verbosity == Verbosity::verbose)
      std::cout << text << std::endl;
  }

  void Log::warning(const std::string &text) const
  {
    if (prints)
      std::cerr << "warning: " + text + '\n' << std::flush; // in one piece: mpirun forwards pieces
  }

  std::string format(const char *pattern, ...)
  {
    va_list arguments, again;
    va_start(arguments, pattern);
    va_copy(again, arguments);
    const int length = std::vsnprintf(nullptr, 0, pattern, arguments);
    AssertThrow(length >= 0, dealii::ExcMessage(std::string("invalid pattern or text: ") + pattern));
    std::string text(length, ' ');
    std::vsnprintf(text.data(), text.size() + 1, pattern, again);
    va_end(again);
    va_end(arguments);
    return text;
  }

  StageClock::StageClock()
    : start(MPI_Wtime() - process_age())
    , entered(start)
  {}

  void StageClock::enter(const std::string &stage)
  {
    const double now = MPI_Wtime();
    stages[present] += now - entered;
    present = stage;
    entered = now;
  }

  void StageClock::leave()
  {
    enter("other");
  }

  double StageClock::seconds(const std::string &stage) const
  {
    const auto found = stages.find(stage);
    return (found == stages.end() ? 0. : found->second) + (stage == present ? MPI_Wtime() - entered : 0.);
  }

  double StageClock::total() const
  {
    return MPI_Wtime() - start;
  }

  double process_age()
  {
    // /proc/self/stat: field 22 is the start in clock ticks since boot; field 2 may contain spaces
    std::ifstream file("/proc/self/stat");
    std::string   text;
    std::getline(file, text);
    const auto         end_of_name = text.rfind(')');
    std::istringstream fields(end_of_name == std::string::npos ? "" : text.substr(end_of_name + 1));
    std::string        skipped;
    for (unsigned int field = 3; field < 22; ++field)
      fields >> skipped;
    double   ticks;
    timespec now;
    if (!(fields >> ticks) || clock_gettime(CLOCK_BOOTTIME, &now) != 0)
      return 0;
    return std::max(0., now.tv_sec + 1e-9 * now.tv_nsec - ticks / sysconf(_SC_CLK_TCK));
  }

  double peak_memory_mb()
  {
    // deal.II's function that reads this file never returns if /proc is missing
    std::ifstream status("/proc/self/status");
    std::string   word;
    double        kilobytes;
    while (status >> word)
      if (word == "VmHWM:" && status >> kilobytes)
        return kilobytes / 1024;
    rusage usage; // may include memory used by the process before this program
    return getrusage(RUSAGE_SELF, &usage) == 0 ? usage.ru_maxrss / 1024. : 0;
  }
} // namespace slipstick
