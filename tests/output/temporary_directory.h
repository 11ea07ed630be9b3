// A directory of its own for every test, the same on all ranks.
#pragma once

#include <deal.II/base/mpi.h>

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>

#include <unistd.h>

class TemporaryDirectory : public testing::Test
{
protected:
  TemporaryDirectory()
    : root(std::filesystem::temp_directory_path() /
           ("slipstick-test-" + std::to_string(dealii::Utilities::MPI::broadcast(MPI_COMM_WORLD, int(getpid())))))
  {
    if (is_root())
      std::filesystem::create_directory(root);
    MPI_Barrier(MPI_COMM_WORLD);
  }

  ~TemporaryDirectory() override
  {
    MPI_Barrier(MPI_COMM_WORLD);
    if (is_root())
      std::filesystem::remove_all(root);
  }

  static bool is_root()
  {
    return dealii::Utilities::MPI::this_mpi_process(MPI_COMM_WORLD) == 0;
  }

  static std::string content(const std::string &file)
  {
    std::ostringstream text;
    text << std::ifstream(file, std::ios::binary).rdbuf();
    return text.str();
  }

  const std::filesystem::path root;
};
