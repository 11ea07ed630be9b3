// Memory that runs out is an error of the input, whoever notices it.
#include <slipstick/base/collective.h>
#include <slipstick/base/memory.h>

#include <deal.II/base/exceptions.h>

#include <gtest/gtest.h>

using namespace slipstick;

TEST(OutOfMemory, errors_of_libraries)
{
  EXPECT_TRUE(is_out_of_memory(std::bad_alloc()));
  EXPECT_TRUE(is_out_of_memory(dealii::StandardExceptions::ExcOutOfMemory(788632)));
  EXPECT_FALSE(is_out_of_memory(std::runtime_error("memory")));
  EXPECT_THROW(collectively(MPI_COMM_WORLD, [] { throw dealii::StandardExceptions::ExcOutOfMemory(788632); }),
               InputError);
  EXPECT_THROW(collectively(MPI_COMM_WORLD, [] { throw std::bad_alloc(); }), InputError);
}
