// MPGP on many random problems: against enumeration, two-sided boxes, scaling.
#include "mpgp.h"

using namespace slipstick::qp;
using namespace slipstick::qp::test;

class MpgpRandom : public WithExpansion
{};

INSTANTIATE_TEST_SUITE_P(AllExpansions, MpgpRandom, testing::ValuesIn(all_expansions));

TEST_P(MpgpRandom, agrees_with_the_enumeration_of_all_active_sets)
{
  for (unsigned int seed = 0; seed < 400; ++seed)
    {
      Random            random(seed);
      const std::size_t n   = 2 + seed % 4;
      const Matrix      A   = random.semidefinite(n, n, 0.05);
      const Vector      b   = random.vector(n, 2);
      auto              box = random.box(n, seed % 2 == 0);
      if (seed % 3 == 0)
        box.upper[0] = infinity;
      const auto exact  = enumerate(A, b, Matrix(0, n), {}, box);
      const auto result = run_mpgp(A, b, box, {random.vector(n)}, 1e-11, options(), spectral_norm(A));
      ASSERT_TRUE(exact) << seed;
      EXPECT_EQ(result.status, Status::converged) << seed;
      EXPECT_TRUE(is_within(box, result.x)) << seed;
      EXPECT_LT(distance(result.x, *exact), 1e-8) << seed;
    }
}

TEST_P(MpgpRandom, every_two_sided_box_problem_converges)
{
  for (unsigned int seed = 0; seed < 100; ++seed)
    {
      Random            random(seed);
      const std::size_t n      = 40;
      const Matrix      A      = random.semidefinite(n, n + 5 - seed % 10, 1e-3);
      const Vector      b      = random.vector(n, 5);
      const auto        box    = random.box(n, seed % 2 == 0, seed % 5 == 0 ? 1e-2 : 1.0);
      const auto        result = run_mpgp(A, b, box, {random.vector(n)}, 1e-8, options(), spectral_norm(A));
      EXPECT_EQ(result.status, Status::converged) << seed;
      EXPECT_TRUE(is_within(box, result.x)) << seed;
      EXPECT_LT(kkt_residual(A, result.x, b, box), 1e-7) << seed;
    }
}

TEST_P(MpgpRandom, solution_does_not_depend_on_the_start)
{
  Random       random(1);
  const Matrix A    = random.semidefinite(20, 20, 0.05);
  const Vector b    = random.vector(20, 5);
  const auto   box  = random.box(20, false);
  const double norm = spectral_norm(A);
  const Vector x    = run_mpgp(A, b, box, {Vector(20, 0.0)}, 1e-11, options(), norm).x;
  for (const Vector &start : {box.lower, box.upper, Vector(20, 100.0)})
    EXPECT_LT(distance(x, run_mpgp(A, b, box, {start}, 1e-11, options(), norm).x), 1e-9);
}

TEST_P(MpgpRandom, iterates_do_not_depend_on_the_unit_of_the_objective)
{
  const double unit = 1048576; // a power of two, so that scaling causes no rounding
  for (unsigned int seed = 0; seed < 20; ++seed)
    {
      Random       random(seed);
      Matrix       A     = random.semidefinite(20, 20, 0.05);
      Vector       b     = random.vector(20, 5);
      const auto   box   = random.box(20, false);
      const double norm  = spectral_norm(A);
      const auto   plain = run_mpgp(A, b, box, {Vector(20, 0.0)}, 1e-9, options(), norm);
      for (double &entry : A.entries)
        entry *= unit;
      for (double &entry : b)
        entry *= unit;
      const auto scaled = run_mpgp(A, b, box, {Vector(20, 0.0)}, 1e-9 * unit, options(), norm * unit);
      EXPECT_EQ(plain.x, scaled.x) << seed;
      EXPECT_EQ(plain.counts.hessian_multiplications, scaled.counts.hessian_multiplications) << seed;
    }
}
