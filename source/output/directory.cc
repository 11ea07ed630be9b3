#include <slipstick/base/collective.h>
#include <slipstick/base/exceptions.h>
#include <slipstick/output/directory.h>

#include <deal.II/base/mpi.h>

#include <cerrno>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <locale>
#include <regex>
#include <system_error>

namespace slipstick::output
{
  namespace
  {
    const std::string other_directory = "choose another directory with --output DIR";

    [[noreturn]] void reject(const std::string &path, const std::string &reason)
    {
      throw InputError("Output directory '" + path + "': " + reason, other_directory);
    }

    // Permission bits do not tell (root ignores them, read-only and full disks do not show in them): try a file.
    void try_a_file(const std::filesystem::path &directory)
    {
      const std::filesystem::path probe = directory / ".slipstick-probe.tmp";
      errno                             = 0;
      std::ofstream file(probe);
      file << "probe\n";
      file.close();
      const int       error = errno;
      std::error_code ignored;
      std::filesystem::remove(probe, ignored);
      if (file.fail())
        reject(directory.string(), std::string("no file can be written there: ") + std::strerror(error));
    }

    /// Creates @p path; returns what was missing, outermost first.
    std::vector<std::string> prepare(const std::string &path)
    {
      if (path.empty())
        throw InputError("The name of the output directory is empty", "name one: --output DIR");
      std::error_code error;
      if (std::filesystem::exists(path, error) && !std::filesystem::is_directory(path, error))
        reject(path, "there is a file of that name");
      std::vector<std::string> missing;
      for (std::filesystem::path p = path; !p.empty() && !std::filesystem::exists(p, error); p = p.parent_path())
        missing.insert(missing.begin(), p.string());
      std::filesystem::create_directories(path, error);
      if (error)
        reject(path, "cannot be created: " + error.message());
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
      std::filesystem::remove(*path, ignored); // fails on one that is not empty
  }

  void OutputDirectory::remove_results() const
  {
    static const std::regex result("solution\\.pvd|solution_\\d+\\.pvtu|subdomain_\\d+_\\d+\\.vtu|contact_\\d+\\.vtp|"
                                   "contact\\.csv|convergence\\.csv|history\\.csv|summary\\.json|parameters\\.prm");
    collectively(communicator, [&] {
      if (dealii::Utilities::MPI::this_mpi_process(communicator) != 0)
        return;
      std::vector<std::filesystem::path> old;
      for (const auto &entry : std::filesystem::directory_iterator(directory))
        if (entry.is_regular_file() && std::regex_match(entry.path().filename().string(), result))
          old.push_back(entry.path());
      for (const auto &file : old)
        std::filesystem::remove(file);
    });
  }

  std::string OutputDirectory::path(const std::string &name) const
  {
    return name.empty() ? directory : (std::filesystem::path(directory) / name).string();
  }

  void OutputDirectory::write(const std::string &name, const std::function<void(std::ostream &)> &content) const
  {
    const std::string final_name = path(name);
    const std::string temporary  = final_name + ".tmp";
    const auto        fail       = [&](const std::string &reason) {
      throw Error("Could not write '" + final_name + "': " + reason, "free space there or " + other_directory);
    };
    try
      {
        errno = 0;
        std::ofstream file(temporary, std::ios::binary);
        file.imbue(std::locale::classic());
        if (file)
          content(file);
        file.close();
        if (file.fail())
          fail(errno != 0 ? std::strerror(errno) : "the stream failed");
        std::error_code error;
        std::filesystem::rename(temporary, final_name, error);
        if (error)
          fail(error.message());
      }
    catch (...)
      {
        std::error_code ignored;
        std::filesystem::remove(temporary, ignored);
        throw;
      }
  }

  void OutputDirectory::write_from_root(const std::string                         &name,
                                        const std::function<void(std::ostream &)> &content) const
  {
    collectively(communicator, [&] {
      if (dealii::Utilities::MPI::this_mpi_process(communicator) == 0)
        write(name, content);
    });
  }
} // namespace slipstick::output
