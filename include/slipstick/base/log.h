// Console output of the program; only rank 0 prints.
#pragma once

#include <mpi.h>

#include <map>
#include <string>
#include <vector>

namespace slipstick
{
  enum class Verbosity
  {
    quiet,
    normal,
    verbose
  };

  /// Progress on standard output, from rank 0, flushed line by line. Warnings go to standard error.
  class Log
  {
  public:
    Log(const MPI_Comm comm, const Verbosity verbosity);

    /// A line at normal verbosity.
    void line(const std::string &text) const;

    /// A line at normal verbosity that belongs to a stage, indented like the text of the stages' own lines.
    void remark(const std::string &text) const;

    /// A line at verbose verbosity only.
    void detail(const std::string &text) const;

    /// "warning: TEXT" on standard error, at every verbosity.
    void warning(const std::string &text) const;

  private:
    bool      prints;
    Verbosity verbosity;
  };

  /// printf-style formatting into a string.
  std::string format(const char *pattern, ...) __attribute__((format(printf, 1, 2)));

  /// Wall time of the stages of a run [s]. Stages are not nested: entering one ends the previous one, so that they add
  /// up to the time since the start of the process, which counts as stage "startup" until the first one is entered.
  class StageClock
  {
  public:
    StageClock();

    void enter(const std::string &stage);
    /// Ends the current stage; time then counts as "other" until the next stage.
    void   leave();
    double seconds(const std::string &stage) const;
    double total() const;

  private:
    double                        start;
    double                        entered;
    std::string                   present = "startup";
    std::map<std::string, double> stages;
  };

  /// Age of this process [s], to the resolution of the kernel's clock (10 ms); 0 if the system does not provide it.
  double process_age();

  /// Peak resident memory of this process so far [MB].
  double peak_memory_mb();
} // namespace slipstick
