// main() of a GoogleTest executable under MPI: rank 0 reports as usual, the other ranks report failures only.
#include <slipstick/tfeti/process.h>

#include <deal.II/base/mpi.h>

#include <gtest/gtest.h>

#include <iostream>

#ifdef __SANITIZE_ADDRESS__
#  include "keep_libraries.cc"
#endif

namespace
{
  class FailurePrinter : public testing::EmptyTestEventListener
  {
    void OnTestPartResult(const testing::TestPartResult &result) override
    {
      if (result.failed())
        std::cerr << "rank " << dealii::Utilities::MPI::this_mpi_process(MPI_COMM_WORLD) << ": " << result << std::endl;
    }
  };
} // namespace

int main(int argc, char **argv)
{
  testing::InitGoogleTest(&argc, argv);
  slipstick::tfeti::Process process;
  if (dealii::Utilities::MPI::this_mpi_process(MPI_COMM_WORLD) != 0)
    {
      testing::TestEventListeners &listeners = testing::UnitTest::GetInstance()->listeners();
      delete listeners.Release(listeners.default_result_printer());
      listeners.Append(new FailurePrinter);
    }
  return RUN_ALL_TESTS();
}
