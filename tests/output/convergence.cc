#include <slipstick/output/convergence.h>

#include "temporary_directory.h"

using namespace slipstick::output;

namespace
{
  using Convergence = TemporaryDirectory;
}

TEST_F(Convergence, rows_hold_the_columns_of_the_header)
{
  const OutputDirectory directory(root, MPI_COMM_WORLD);
  ConvergenceRow        row;
  row.step                    = 1;
  row.algorithm               = "semismooth newton";
  row.friction_step           = 2;
  row.outer_step              = 3;
  row.hessian_multiplications = 5000000000;
  row.projected_gradient      = 1e-5;
  row.equality                = 0.25;
  row.at_lower_bound          = 6;
  row.at_upper_bound          = 7;
  row.free                    = 8;
  write_convergence(directory, {row});
  EXPECT_EQ(content(directory.path("convergence.csv")),
            "step,algorithm,friction_step,outer_step,hessian_multiplications,projected_gradient,equality,"
            "at_lower_bound,at_upper_bound,free\n"
            "1,semismooth newton,2,3,5000000000,1e-05,0.25,6,7,8\n");
}

TEST_F(Convergence, no_steps_leave_the_header_alone)
{
  const OutputDirectory directory(root, MPI_COMM_WORLD);
  write_convergence(directory, {});
  const std::string text = content(directory.path("convergence.csv"));
  EXPECT_EQ(text.find('\n'), text.size() - 1);
}
