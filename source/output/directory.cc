#include <slipstick/base/collective.h>
#include <slipstick/base/exceptions.h>
#include <slipstick/output/directory.h>

#include <deal.II/base/mpi.h>

#include <cerrno>
#include <csignal>
#include <cstring>
#include <ext/stdio_filebuf.h>
#include <fcntl.h>
#include <filesystem>
#include <iomanip>
#include <locale>
#include <random>
#include <regex>
#include <sstream>
#include <system_error>
#include <unistd.h>

namespace slipstick::output
{
  namespace
  {
    const std::string other_directory = "choose another directory with --output DIR";

    [[noreturn]] void reject(const std::string &path, const std::string &reason)
    {
      throw InputError("Output directory '" + path + "': " + reason, other_directory);
    }

    const std::string result_names =
      "solution\\.pvd|solution_\\d+\\.pvtu|subdomain_\\d+_\\d+\\.vtu|contact_\\d+\\.vtp|contact\\.pvd|contact\\.csv|"
      "conditions\\.csv|convergence\\.csv|history\\.csv|probes\\.csv|summary\\.json|parameters\\.prm|"
      "restart\\.bin|restart_\\d+_\\d+\\.bin";

    /// Temporary name next to @p name; it contains the process number, which shows whether the file is still being
    /// written, and a random part.
    std::string temporary_name(const std::string &name)
    {
      std::random_device random;
      std::ostringstream text;
      text << name << '.' << getpid() << '-' << std::hex << std::setw(8) << std::setfill('0') << random() << ".tmp";
      return text.str();
    }

    /// A new file; nothing is written through an existing link.
    class NewFile
    {
    public:
      explicit NewFile(const std::string &name)
        : path(name)
        , buffer((errno = 0, open(name.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_NOFOLLOW | O_CLOEXEC, 0666)),
                 std::ios::out | std::ios::binary)
        , is_open(buffer.is_open())
        , error(is_open ? 0 : errno)
      {}

      ~NewFile()
      {
        if (is_open && !is_renamed)
          unlink(path.c_str());
      }

      /// @return why the file is not complete; empty if it is.
      std::string fill(const std::function<void(std::ostream &)> &content)
      {
        if (is_open)
          {
            std::ostream out(&buffer);
            out.imbue(std::locale::classic());
            errno = 0;
            try
              {
                content(out);
              }
            catch (const std::exception &)
              {
                if (out) // the failure has a cause other than lack of space
                  throw;
              }
            const bool failed = !out.flush();
            error             = errno;
            errno             = 0;
            if (const bool closed = buffer.close() != nullptr; !failed && closed)
              return "";
            error = error != 0 ? error : errno;
          }
        return error != 0 ? std::strerror(error) : "the stream failed";
      }

      std::string take_name(const std::string &final_name)
      {
        is_renamed = std::rename(path.c_str(), final_name.c_str()) == 0;
        return is_renamed ? "" : std::strerror(errno);
      }

    private:
      std::string                    path;
      __gnu_cxx::stdio_filebuf<char> buffer;
      bool                           is_open;
      int                            error;
      bool                           is_renamed = false;
    };

    /// @throws InputError unless @p reason is empty
    void check_written(const std::string &reason, const std::string &final_name)
    {
      if (!reason.empty())
        throw InputError("Could not write '" + final_name + "': " + reason + "; what was written before it is complete",
                         "free space there or " + other_directory);
    }

    // Permission bits are not sufficient (root ignores them; they do not reveal read-only or full disks): write a file.
    void try_a_file(const std::filesystem::path &directory)
    {
      NewFile           probe(temporary_name((directory / ".slipstick-probe").string()));
      const std::string reason = probe.fill([](std::ostream &out) { out << "probe\n"; });
      if (!reason.empty())
        reject(directory.string(), "no file can be written there: " + reason);
    }

    /// Removes partial files of killed runs.
    void remove_stale(const std::filesystem::path &directory)
    {
      static const std::regex stale("(" + result_names + "|\\.slipstick-probe)(\\.(\\d{1,9})-[0-9a-f]+)?\\.tmp");
      std::error_code         error;
      std::vector<std::filesystem::path> found;
      for (std::filesystem::directory_iterator entry(directory, error), end; !error && entry != end;
           entry.increment(error))
        {
          std::smatch       match;
          const std::string name = entry->path().filename().string();
          if (std::regex_match(name, match, stale) &&
              (match[3].length() == 0 || (kill(std::stoi(match[3]), 0) != 0 && errno == ESRCH)))
            found.push_back(entry->path());
        }
      for (const auto &path : found)
        if (!std::filesystem::is_directory(std::filesystem::symlink_status(path, error)))
          std::filesystem::remove(path, error);
    }

    /// Creates @p path. @return the directories that were missing, outermost first.
    std::vector<std::string> prepare(const std::string &path)
    {
      if (path.empty())
        throw InputError("The name of the output directory is empty", "name one: --output DIR");
      std::error_code error;
      if (std::filesystem::exists(path, error) && !std::filesystem::is_directory(path, error))
        reject(path, "a file of that name exists");
      std::vector<std::string> missing;
      for (std::filesystem::path p = path; !p.empty() && !std::filesystem::exists(p, error); p = p.parent_path())
        missing.insert(missing.begin(), p.string());
      std::filesystem::create_directories(path, error);
      if (error)
        reject(path, "cannot be created: " + error.message());
      remove_stale(path);
      try_a_file(path);
      return missing;
    }
  } // namespace

  OutputDirectory::OutputDirectory(const std::string &path, const MPI_Comm comm)
    : directory(path)
    , communicator(comm)
  {
    collectively(comm, [&] {
      if (dealii::Utilities::MPI::this_mpi_process(comm) == 0)
        created = prepare(path);
    });
  }

  void OutputDirectory::remove_if_new() const
  {
    std::error_code ignored;
    for (auto path = created.rbegin(); path != created.rend(); ++path)
      std::filesystem::remove(*path, ignored); // fails if it is not empty
  }

  void OutputDirectory::remove_results() const
  {
    static const std::regex result(result_names);
    collectively(communicator, [&] {
      if (dealii::Utilities::MPI::this_mpi_process(communicator) != 0)
        return;
      std::vector<std::filesystem::path> old;
      std::error_code                    error;
      for (std::filesystem::directory_iterator entry(directory, error), end; !error && entry != end;
           entry.increment(error))
        if (entry->is_regular_file(error) && std::regex_match(entry->path().filename().string(), result))
          old.push_back(entry->path());
      for (const auto &file : old)
        if (!std::filesystem::remove(file, error) && error)
          reject(directory,
                 "'" + file.filename().string() + "' of an earlier run cannot be removed: " + error.message());
    });
  }

  std::string OutputDirectory::path(const std::string &name) const
  {
    return name.empty() ? directory : (std::filesystem::path(directory) / name).string();
  }

  void OutputDirectory::write(const std::string &name, const std::function<void(std::ostream &)> &content) const
  {
    const std::string final_name = path(name);
    const auto        file       = std::make_shared<NewFile>(temporary_name(final_name));
    check_written(file->fill(content), final_name);
    const auto appear = [file, final_name] { check_written(file->take_name(final_name), final_name); };
    if (waiting)
      waiting->emplace_back(appear);
    else
      appear();
  }

  void OutputDirectory::write_from_root(const std::string                         &name,
                                        const std::function<void(std::ostream &)> &content) const
  {
    collectively(communicator, [&] {
      if (dealii::Utilities::MPI::this_mpi_process(communicator) == 0)
        write(name, content);
    });
  }

  void OutputDirectory::write_together(const std::function<void(const OutputDirectory &)> &write_files) const
  {
    OutputDirectory together = *this;
    together.waiting         = std::make_shared<std::vector<std::function<void()>>>();
    write_files(together);
    collectively(communicator, [&] {
      for (const auto &appear : *together.waiting)
        appear();
    });
  }
} // namespace slipstick::output
