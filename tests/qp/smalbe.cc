// SMALBE-M: known solutions, equalities, invariances, degenerate problems.
#include "support.h"

#include <slipstick/qp/smalbe.h>

using namespace slipstick::qp;
using namespace slipstick::qp::test;

namespace
{
  SmalbeOptions with(const Expansion expansion)
  {
    SmalbeOptions options;
    options.inner.expansion = expansion;
    return options;
  }

  struct Instance
  {
    Instance(const unsigned int seed, const std::size_t n, const std::size_t m, const double shift = 0.05)
      : random(seed)
      , problem(random.semidefinite(n, n, shift), random.orthonormal(m, n))
      , box(random.box(n, true))
      , norm(spectral_norm(problem.F))
    {
      for (double &entry : problem.F.entries)
        entry /= norm;
      norm = 1;
      b    = problem.kernel(random.vector(n));
    }

    SmalbeResult<Vector> solve(const double         tolerance,
                               const SmalbeOptions &options  = {},
                               const Observer      &observer = {}) const
    {
      return smalbe(problem, norm, b, box, SmalbeStart<Vector>{Vector(b.size(), 0.0)}, tolerance, options, observer);
    }

    Random       random;
    DenseProblem problem;
    Box<Vector>  box;
    double       norm;
    Vector       b;
  };
} // namespace

class Smalbe : public testing::TestWithParam<Expansion>
{};

INSTANTIATE_TEST_SUITE_P(AllExpansions, Smalbe, testing::ValuesIn(all_expansions));

TEST_P(Smalbe, agrees_with_the_enumeration_of_all_active_sets)
{
  for (unsigned int seed = 0; seed < 300; ++seed)
    {
      const std::size_t n = 3 + seed % 3, m = 1 + seed % 2;
      const Instance    p(seed, n, m);
      const auto        exact  = enumerate(p.problem.F, p.b, p.problem.G, Vector(m, 0.0), p.box);
      const auto        result = p.solve(1e-10, with(GetParam()));
      ASSERT_TRUE(exact) << seed;
      EXPECT_EQ(result.status, Status::converged) << seed;
      EXPECT_TRUE(is_within(p.box, result.x)) << seed;
      EXPECT_LT(distance(result.x, *exact), 1e-7) << seed;
    }
}

TEST_P(Smalbe, agrees_with_the_enumeration_without_equalities)
{
  for (unsigned int seed = 0; seed < 100; ++seed)
    {
      const Instance p(seed, 4, 0);
      const auto     exact  = enumerate(p.problem.F, p.b, p.problem.G, {}, p.box);
      const auto     result = p.solve(1e-10, with(GetParam()));
      ASSERT_TRUE(exact) << seed;
      EXPECT_EQ(result.status, Status::converged) << seed;
      EXPECT_LT(distance(result.x, *exact), 1e-7) << seed;
    }
}

TEST_P(Smalbe, bounds_and_equalities_and_gradient_hold_to_the_tolerance)
{
  for (unsigned int seed = 0; seed < 30; ++seed)
    for (const double tolerance : {1e-4, 1e-8})
      {
        const Instance p(seed, 40, 5, 1e-2);
        const auto     result = p.solve(tolerance, with(GetParam()));
        ASSERT_EQ(result.status, Status::converged) << seed;
        EXPECT_TRUE(is_within(p.box, result.x)) << seed;
        EXPECT_LE(length(p.problem.range(result.x)), (1 + 1e-9) * tolerance * length(p.b)) << seed;
        // the gradient recomputed: P F P x + rho Q x - b + shift
        Vector g = p.problem.kernel(p.problem.F * p.problem.kernel(result.x));
        add(result.penalty, p.problem.range(result.x), g);
        add(1.0, result.shift, g);
        add(-1.0, p.b, g);
        EXPECT_LT(distance(g, result.gradient), 1e-11) << seed;
        EXPECT_LE(projected_gradient_norm(p.box, result.x, g), (1 + 1e-4) * tolerance * length(p.b)) << seed;
      }
}

TEST_P(Smalbe, one_sided_bounds_with_free_entries)
{
  for (unsigned int seed = 0; seed < 50; ++seed)
    {
      Instance p(seed, 5, 2);
      p.box             = {{0, 0, -infinity, -0.2, -infinity}, {infinity, infinity, infinity, 0.2, infinity}};
      const auto exact  = enumerate(p.problem.F, p.b, p.problem.G, {0, 0}, p.box);
      const auto result = p.solve(1e-10, with(GetParam()));
      ASSERT_TRUE(exact) << seed;
      EXPECT_EQ(result.status, Status::converged) << seed;
      EXPECT_LT(distance(result.x, *exact), 1e-7) << seed;
    }
}

TEST_P(Smalbe, entries_fixed_at_zero_drop_out)
{
  Instance p(11, 5, 1);
  p.box.lower[1] = p.box.upper[1] = 0;
  p.box.lower[3] = p.box.upper[3] = 0;
  const auto result               = p.solve(1e-10, with(GetParam()));
  EXPECT_EQ(result.status, Status::converged);
  EXPECT_LT(distance(result.x, *enumerate(p.problem.F, p.b, p.problem.G, {0}, p.box)), 1e-7);
}

TEST_P(Smalbe, iterates_do_not_depend_on_the_unit_of_the_objective)
{
  const double unit = 1048576; // a power of two, so that scaling causes no rounding
  for (unsigned int seed = 0; seed < 10; ++seed)
    {
      const Instance p(seed, 30, 4);
      Instance       q(seed, 30, 4);
      for (double &entry : q.problem.F.entries)
        entry *= unit;
      for (double &entry : q.b)
        entry *= unit;
      q.norm *= unit;
      EXPECT_EQ(p.solve(1e-8, with(GetParam())).x, q.solve(1e-8, with(GetParam())).x) << seed;
    }
}

TEST_P(Smalbe, iterates_do_not_depend_on_the_unit_of_the_multipliers)
{
  const double   unit = 1048576;
  const Instance p(2, 30, 4);
  Instance       q(2, 30, 4);
  for (Vector *v : {&q.b, &q.box.lower, &q.box.upper})
    for (double &entry : *v)
      entry *= unit;
  Vector expected = p.solve(1e-8, with(GetParam())).x;
  for (double &entry : expected)
    entry *= unit;
  EXPECT_EQ(q.solve(1e-8, with(GetParam())).x, expected);
}

TEST_P(Smalbe, counter_equals_the_number_of_calls_of_the_operator)
{
  for (unsigned int seed = 0; seed < 20; ++seed)
    {
      const Instance p(seed, 30, 4);
      const auto     result = p.solve(1e-8, with(GetParam()));
      EXPECT_GT(result.counts.hessian_multiplications, 0u);
      EXPECT_EQ(result.counts.hessian_multiplications, p.problem.n_multiplications) << seed;
    }
}

TEST_P(Smalbe, tiny_boxes_converge)
{
  for (const double size : {1e-3, 1e-8, 1e-14})
    for (unsigned int seed = 0; seed < 20; ++seed)
      {
        Instance p(seed, 20, 3);
        p.box             = p.random.box(20, true, size);
        const auto result = p.solve(1e-6, with(GetParam()));
        EXPECT_EQ(result.status, Status::converged) << seed << ' ' << size;
        EXPECT_TRUE(is_within(p.box, result.x));
      }
}

TEST(SmalbeStart, zero_right_hand_side_returns_zero_without_a_multiplication)
{
  Instance p(3, 10, 2);
  set_zero(p.b);
  const auto result = p.solve(1e-6);
  EXPECT_EQ(result.status, Status::converged);
  EXPECT_EQ(result.x, Vector(10, 0.0));
  EXPECT_EQ(p.problem.n_multiplications, 0u);
}

TEST(SmalbeStart, zero_right_hand_side_from_elsewhere_returns_to_zero)
{
  Instance p(3, 10, 2);
  set_zero(p.b);
  Vector start = p.random.vector(10);
  project(p.box, start);
  const auto result = smalbe(p.problem, 1.0, p.b, p.box, SmalbeStart<Vector>{start}, 1e-9);
  EXPECT_EQ(result.status, Status::converged);
  EXPECT_LT(length(result.x), 1e-6 * length(start));
}

TEST(SmalbeStart, solution_with_its_multiplier_is_recognised_with_one_multiplication)
{
  const Instance p(4, 20, 3);
  const auto     first = p.solve(1e-9);
  const auto     again = smalbe(p.problem, 1.0, p.b, p.box, SmalbeStart<Vector>{first.x, first.shift}, 2e-9);
  EXPECT_EQ(again.status, Status::converged);
  EXPECT_EQ(again.counts.hessian_multiplications, 1u);
  EXPECT_EQ(again.x, first.x);
}

TEST(SmalbeStart, reference_of_the_goal_replaces_that_of_the_right_hand_side)
{
  const Instance p(5, 20, 3);
  const auto     result =
    smalbe(p.problem, 1.0, p.b, p.box, SmalbeStart<Vector>{Vector(20, 0.0)}, Goal(1e-10, 1e4 * length(p.b)));
  EXPECT_EQ(result.status, Status::converged);
  EXPECT_LE(length(p.problem.range(result.x)), 1e-6 * length(p.b));
  EXPECT_DOUBLE_EQ(result.reference, 1e4 * length(p.b));
}

TEST(SmalbeObserver, sees_every_outer_step_and_the_final_residuals)
{
  const Instance         p(6, 30, 4);
  std::vector<OuterStep> steps;
  const auto             result = p.solve(1e-8, {}, [&](const OuterStep &step) { steps.push_back(step); });
  ASSERT_EQ(steps.size(), result.counts.outer_iterations);
  for (std::size_t k = 0; k < steps.size(); ++k)
    EXPECT_EQ(steps[k].outer, k + 1);
  EXPECT_EQ(steps.back().hessian_multiplications, result.counts.hessian_multiplications);
  EXPECT_EQ(steps.back().projected_gradient, result.projected_gradient);
  EXPECT_EQ(steps.back().equality_residual, result.equality_residual);
  const auto active = own_active(p.box, result.x);
  EXPECT_GT(active.lower + active.upper, 0u);
  EXPECT_EQ(steps.back().active_lower, active.lower);
  EXPECT_EQ(steps.back().active_upper, active.upper);
}

TEST(SmalbeDegenerate, semidefinite_hessian_converges)
{
  for (unsigned int seed = 0; seed < 30; ++seed)
    {
      Instance p(seed, 20, 3);
      p.problem.F        = p.random.semidefinite(20, 8, 0);
      const double scale = spectral_norm(p.problem.F);
      for (double &entry : p.problem.F.entries)
        entry /= scale;
      EXPECT_EQ(p.solve(1e-6).status, Status::converged) << seed;
    }
}

TEST(SmalbeDegenerate, bounds_that_contradict_the_equality_are_reported)
{
  // sum of the entries = 0, all of them >= 1
  Matrix G(1, 4);
  G.entries = Vector(4, 0.5);
  const DenseProblem problem(diagonal({1, 1, 1, 1}), G);
  const Vector       b{1, -1, 2, -2};
  const Box<Vector>  box{Vector(4, 1.0), Vector(4, 2.0)};
  const auto         result = smalbe(problem, 1.0, b, box, SmalbeStart<Vector>{Vector(4, 0.0)}, 1e-6);
  EXPECT_EQ(result.status, Status::infeasible);
}

TEST(SmalbeDegenerate, contradicting_bounds_are_reported)
{
  Instance p(7, 10, 2);
  p.box.lower[4] = 2 * p.box.upper[4] + 1;
  EXPECT_EQ(p.solve(1e-6).status, Status::infeasible);
}

TEST(SmalbeDegenerate, unreachable_accuracy_ends)
{
  const Instance p(8, 20, 3);
  const auto     result = p.solve(1e-20);
  EXPECT_EQ(result.status, Status::stagnated);
  EXPECT_LT(result.projected_gradient, 1e-10);
  EXPECT_LT(result.equality_residual, 1e-10);
}

TEST(SmalbeDegenerate, outer_limit_is_kept)
{
  const Instance p(9, 30, 4);
  SmalbeOptions  options;
  options.max_outer_iterations = 2;
  const auto result            = p.solve(1e-10, options);
  EXPECT_EQ(result.status, Status::iteration_limit);
  EXPECT_EQ(result.counts.outer_iterations, 2u);
}

TEST(SmalbeDegenerate, limit_of_multiplications_is_kept)
{
  const Instance instance(3, 40, 6);
  SmalbeOptions  options;
  const auto     all          = instance.solve(1e-12, options);
  options.max_multiplications = 20;
  const auto cut              = instance.solve(1e-12, options);
  ASSERT_EQ(all.status, Status::converged);
  ASSERT_GT(all.counts.hessian_multiplications, 40);
  EXPECT_EQ(cut.status, Status::iteration_limit);
  EXPECT_LE(cut.counts.hessian_multiplications, 40); // an iteration takes up to two
}

TEST(SmalbeDegenerate, not_a_number_in_the_operator_ends)
{
  Instance p(10, 10, 2);
  p.problem.F(0, 0) = std::nan("");
  EXPECT_EQ(p.solve(1e-6).status, Status::stagnated);
}
