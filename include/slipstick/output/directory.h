// The output directory; files appear in it only when they are complete.
#pragma once

#include <mpi.h>

#include <functional>
#include <iosfwd>
#include <memory>
#include <string>
#include <vector>

namespace slipstick::output
{
  /// An existing, writable directory.
  class OutputDirectory
  {
  public:
    /// Creates @p path and its parents if missing, removes partial files of killed runs, and tries to write a file.
    /// Collective over @p comm: rank 0 does the work.
    /// @throws InputError on all ranks: empty path, a file in its place, no permission, a full or read-only disk.
    OutputDirectory(const std::string &path, const MPI_Comm comm);

    /// Removes the output files of an earlier run (names: doc/interface.md). Collective.
    void remove_results() const;

    /// Path of the file @p name in the directory; empty @p name: of the directory itself.
    std::string path(const std::string &name = "") const;

    /// Writes the file @p name on this rank: @p content writes a temporary file, which is then renamed. An existing
    /// file of that name is replaced; on failure it is kept, and nothing else is left behind. The temporary file is new
    /// and has a random name, so that nothing is written through a link in its place.
    /// @throws InputError on this rank if the file cannot be written; exceptions of @p content pass through.
    void write(const std::string &name, const std::function<void(std::ostream &)> &content) const;

    /// As write(), on rank 0; errors are thrown on all ranks. @p content runs on rank 0 and must not communicate.
    /// Collective.
    void write_from_root(const std::string &name, const std::function<void(std::ostream &)> &content) const;

    /// Writes files that must be consistent with each other. @p write_files writes them with write_from_root() of the
    /// directory that it receives; they get their final names together, when all are complete. If one of them cannot be
    /// completed or the run is killed before, the previous files are kept. Collective.
    void write_together(const std::function<void(const OutputDirectory &)> &write_files) const;

    /// Removes the directories created by the constructor if they are empty, so that a rejected scene leaves nothing
    /// behind. Rank 0 does the work; no communication.
    void remove_if_new() const;

  private:
    std::string              directory;
    MPI_Comm                 communicator;
    std::vector<std::string> created; // by the constructor, outermost first; rank 0

    /// Each function gives a complete file its final name; null: files get their final names immediately.
    std::shared_ptr<std::vector<std::function<void()>>> waiting;
  };
} // namespace slipstick::output
