#include <slipstick/base/exceptions.h>
#include <slipstick/output/directory.h>

#include "temporary_directory.h"

#include <algorithm>
#include <csignal>
#include <stdexcept>

#include <sys/resource.h>
#include <unistd.h>

using slipstick::InputError;
using slipstick::output::OutputDirectory;

namespace
{
  using Directory = TemporaryDirectory;

  // The message with which a directory is rejected, empty when it is not.
  std::string rejection(const std::string &path)
  {
    try
      {
        OutputDirectory directory(path, MPI_COMM_WORLD);
        return "";
      }
    catch (const InputError &error)
      {
        return error.what();
      }
  }

  std::ptrdiff_t n_files(const std::filesystem::path &directory)
  {
    return std::distance(std::filesystem::directory_iterator(directory), std::filesystem::directory_iterator());
  }
} // namespace

TEST_F(Directory, missing_parents_are_created)
{
  const OutputDirectory directory(root / "a" / "b", MPI_COMM_WORLD);
  EXPECT_TRUE(std::filesystem::is_directory(root / "a" / "b"));
}

TEST_F(Directory, construction_leaves_nothing_in_it)
{
  const OutputDirectory directory(root, MPI_COMM_WORLD);
  EXPECT_EQ(n_files(root), 0);
}

TEST_F(Directory, file_in_its_place_is_rejected_on_all_ranks)
{
  if (is_root())
    std::ofstream(root / "file") << "in the way";
  const std::string message = rejection(root / "file");
  EXPECT_NE(message.find("a file of that name exists"), std::string::npos) << message;
  EXPECT_NE(message.find("remedy: "), std::string::npos) << message;
}

TEST_F(Directory, file_in_place_of_a_parent_is_rejected_on_all_ranks)
{
  if (is_root())
    std::ofstream(root / "file") << "in the way";
  EXPECT_NE(rejection(root / "file" / "below"), "");
}

TEST_F(Directory, empty_name_is_rejected_on_all_ranks)
{
  EXPECT_NE(rejection("").find("empty"), std::string::npos);
}

TEST_F(Directory, directory_that_cannot_be_created_is_rejected_for_root_too)
{
  EXPECT_NE(rejection("/proc/slipstick"), "");
}

TEST_F(Directory, directory_that_takes_no_file_is_rejected_for_root_too)
{
  const std::string message = rejection("/proc");
  EXPECT_NE(message.find("no file can be written there"), std::string::npos) << message;
}

TEST_F(Directory, written_file_stands_under_its_final_name_only)
{
  const OutputDirectory directory(root, MPI_COMM_WORLD);
  directory.write_from_root("x.txt", [](std::ostream &out) { out << "content\n"; });
  EXPECT_EQ(content(directory.path("x.txt")), "content\n");
  EXPECT_EQ(n_files(root), 1);
}

TEST_F(Directory, every_rank_can_write_its_own_file)
{
  const OutputDirectory directory(root, MPI_COMM_WORLD);
  const unsigned int    rank = dealii::Utilities::MPI::this_mpi_process(MPI_COMM_WORLD);
  directory.write(std::to_string(rank), [&](std::ostream &out) { out << rank; });
  EXPECT_EQ(content(directory.path(std::to_string(rank))), std::to_string(rank));
}

TEST_F(Directory, file_from_before_is_replaced)
{
  const OutputDirectory directory(root, MPI_COMM_WORLD);
  for (const char *text : {"a longer first content", "second"})
    directory.write_from_root("x", [&](std::ostream &out) { out << text; });
  EXPECT_EQ(content(directory.path("x")), "second");
}

TEST_F(Directory, failing_content_leaves_the_file_from_before)
{
  const OutputDirectory directory(root, MPI_COMM_WORLD);
  directory.write_from_root("x", [](std::ostream &out) { out << "whole"; });
  EXPECT_THROW(directory.write_from_root("x",
                                         [](std::ostream &out) {
                                           out << "half";
                                           throw std::runtime_error("stop");
                                         }),
               std::runtime_error);
  EXPECT_EQ(content(directory.path("x")), "whole");
  EXPECT_EQ(n_files(root), 1);
}

TEST_F(Directory, files_written_together_appear_when_all_are_complete)
{
  const OutputDirectory directory(root, MPI_COMM_WORLD);
  const auto            write = [&](const OutputDirectory &to, const std::string &text) {
    for (const char *name : {"x", "y"})
      to.write_from_root(name, [&](std::ostream &out) {
        if (text == "none" && name == std::string("y"))
          throw std::runtime_error("stop");
        out << text;
      });
  };
  write(directory, "before");
  directory.write_together([&](const OutputDirectory &to) {
    write(to, "after");
    if (is_root())
      {
        EXPECT_EQ(content(directory.path("x")), "before");
      }
  });
  for (const char *name : {"x", "y"})
    EXPECT_EQ(content(directory.path(name)), "after");
  EXPECT_THROW(directory.write_together([&](const OutputDirectory &to) { write(to, "none"); }), std::runtime_error);
  EXPECT_EQ(content(directory.path("x")), "after");
  EXPECT_EQ(n_files(root), 2);
}

TEST_F(Directory, full_disk_is_bad_input_on_all_ranks_and_leaves_nothing)
{
  const OutputDirectory directory(root, MPI_COMM_WORLD);
  // files of at most 4 KB, which is as if the disk were full
  rlimit before;
  getrlimit(RLIMIT_FSIZE, &before);
  const rlimit small = {4096, before.rlim_max};
  signal(SIGXFSZ, SIG_IGN);
  setrlimit(RLIMIT_FSIZE, &small);
  std::string message;
  try
    {
      directory.write_from_root("x", [](std::ostream &out) { out << std::string(100000, 'x'); });
    }
  catch (const InputError &error)
    {
      message = error.what();
    }
  setrlimit(RLIMIT_FSIZE, &before);
  EXPECT_NE(message.find("File too large"), std::string::npos) << message;
  EXPECT_EQ(n_files(root), 0);
}

TEST_F(Directory, links_are_not_followed_and_what_killed_runs_left_is_removed)
{
  const auto target = root / "elsewhere";
  if (is_root())
    {
      std::ofstream(target) << "precious";
      for (const char *name : {"x.tmp", ".slipstick-probe.tmp", "contact.csv.tmp"})
        std::filesystem::create_symlink(target, root / name);
      std::ofstream(root / "summary.json.999999999-0123abcd.tmp") << "half";
      std::ofstream(root / ("summary.json." + std::to_string(getpid()) + "-0123abcd.tmp")) << "in use";
    }
  MPI_Barrier(MPI_COMM_WORLD);
  const OutputDirectory directory(root, MPI_COMM_WORLD);
  directory.write_from_root("x", [](std::ostream &out) { out << "content"; });
  EXPECT_EQ(content(target), "precious");
  EXPECT_EQ(content(root / "x"), "content");
  EXPECT_EQ(n_files(root), 4); // these two, x.tmp, which is not ours, and the one of a process that lives
}
