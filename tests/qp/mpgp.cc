// MPGP: known solutions, starts, counts, degenerate problems.
#include "mpgp.h"

using namespace slipstick::qp;
using namespace slipstick::qp::test;

class Mpgp : public WithExpansion
{};

INSTANTIATE_TEST_SUITE_P(AllExpansions, Mpgp, testing::ValuesIn(all_expansions));

TEST_P(Mpgp, proportioning_does_not_overshoot_the_far_bound)
{
  // 1/2 x^2 - 5x on [-1, 1]: from x = -1 the unbounded step ends at 5 with zero gradient
  const auto result = run_mpgp(diagonal({1}), {5}, {{-1}, {1}}, {{-1}}, 1e-12, options(), 1);
  EXPECT_EQ(result.status, Status::converged);
  EXPECT_EQ(result.x[0], 1.0);
}

TEST_P(Mpgp, proportioning_does_not_overshoot_when_one_entry_is_much_narrower)
{
  const auto result =
    run_mpgp(diagonal({1, 1, 1}), {5, 5, 0.5}, {{-1, 0, 0}, {1, 1e-9, 1}}, {{-1, 0, 0}}, 1e-12, options(), 1);
  EXPECT_EQ(result.status, Status::converged);
  EXPECT_EQ(result.x[0], 1.0);
  EXPECT_EQ(result.x[1], 1e-9);
  EXPECT_NEAR(result.x[2], 0.5, 1e-12);
}

TEST_P(Mpgp, separable_problem_is_clipped_entry_by_entry)
{
  const Vector      d{1, 0.1, 0.5, 2, 1}, b{3, -0.05, -3, 1, 0.2};
  const Box<Vector> box{{-1, -1, -infinity, -infinity, -1}, {1, 1, infinity, 0.25, 1}};
  const auto        result = run_mpgp(diagonal(d), b, box, {Vector(5, 0.0)}, 1e-12, options(), 2);
  EXPECT_EQ(result.status, Status::converged);
  for (std::size_t i = 0; i < d.size(); ++i)
    EXPECT_NEAR(result.x[i], clip(b[i] / d[i], box.lower[i], box.upper[i]), 1e-10);
}

TEST_P(Mpgp, without_bounds_it_solves_the_linear_system)
{
  Random            random(3);
  const Matrix      A = random.semidefinite(12, 12, 0.05);
  const Vector      b = random.vector(12);
  const Box<Vector> box{Vector(12, -infinity), Vector(12, infinity)};
  const auto        result = run_mpgp(A, b, box, {Vector(12, 0.0)}, 1e-11, options(), spectral_norm(A));
  EXPECT_EQ(result.status, Status::converged);
  EXPECT_LT(distance(result.x, *solve(A, b)), 1e-8);
}

TEST_P(Mpgp, fixed_entries_stay_and_the_others_are_optimal)
{
  Random       random(4);
  const Matrix A   = random.semidefinite(8, 8, 0.1);
  const Vector b   = random.vector(8, 3);
  auto         box = random.box(8, true);
  for (std::size_t i = 0; i < 8; i += 2)
    box.lower[i] = box.upper[i] = 0.1 * static_cast<double>(i) - 0.3;
  const auto result = run_mpgp(A, b, box, {Vector(8, 0.0)}, 1e-11, options(), spectral_norm(A));
  EXPECT_EQ(result.status, Status::converged);
  for (std::size_t i = 0; i < 8; i += 2)
    EXPECT_EQ(result.x[i], box.lower[i]);
  EXPECT_LT(distance(result.x, *enumerate(A, b, Matrix(0, 8), {}, box)), 1e-9);
}

TEST_P(Mpgp, all_entries_fixed_is_converged)
{
  const Vector values{1, -2, 3};
  const auto   result = run_mpgp(diagonal({1, 1, 1}), {5, 5, 5}, {values, values}, {Vector(3, 0.0)}, 0, options(), 1);
  EXPECT_EQ(result.status, Status::converged);
  EXPECT_EQ(result.x, values);
}

TEST_P(Mpgp, zero_right_hand_side_gives_zero_without_a_multiplication)
{
  const auto result = run_mpgp(diagonal({1, 2}), {0, 0}, {{-1, -1}, {1, 1}}, {Vector(2, 0.0)}, 1e-12, options(), 2);
  EXPECT_EQ(result.status, Status::converged);
  EXPECT_EQ(result.x, Vector(2, 0.0));
  EXPECT_EQ(result.counts.hessian_multiplications, 0u);
}

TEST_P(Mpgp, zero_right_hand_side_outside_of_zero_gives_the_nearest_bound)
{
  const auto result = run_mpgp(diagonal({1, 2}), {0, 0}, {{1, -5}, {3, -1}}, {Vector(2, 0.0)}, 1e-12, options(), 2);
  EXPECT_EQ(result.status, Status::converged);
  EXPECT_EQ(result.x, (Vector{1, -1}));
}

TEST_P(Mpgp, semidefinite_hessian_reaches_the_optimality_conditions)
{
  for (unsigned int seed = 0; seed < 100; ++seed)
    {
      Random       random(seed);
      const Matrix A      = random.semidefinite(10, 4, 0);
      const Vector b      = random.vector(10);
      const auto   box    = random.box(10, false);
      const auto   result = run_mpgp(A, b, box, {Vector(10, 0.0)}, 1e-10, options(), spectral_norm(A));
      EXPECT_EQ(result.status, Status::converged) << seed;
      EXPECT_TRUE(is_within(box, result.x)) << seed;
      EXPECT_LT(kkt_residual(A, result.x, b, box), 1e-9) << seed;
    }
}

TEST_P(Mpgp, singular_direction_of_descent_ends_at_the_bound)
{
  const auto result = run_mpgp(diagonal({1, 0}), {1, 1}, {{-5, -5}, {5, 7}}, {Vector(2, 0.0)}, 1e-12, options(), 1);
  EXPECT_EQ(result.status, Status::converged);
  EXPECT_NEAR(result.x[0], 1, 1e-12);
  EXPECT_EQ(result.x[1], 7.0);
}

TEST_P(Mpgp, unbounded_objective_is_reported)
{
  const auto result =
    run_mpgp(diagonal({1, 0}), {1, 1}, {{-5, -5}, {5, infinity}}, {Vector(2, 0.0)}, 1e-12, options(), 1);
  EXPECT_EQ(result.status, Status::infeasible);
}

TEST_P(Mpgp, contradicting_bounds_are_reported)
{
  const auto result = run_mpgp(diagonal({1, 1}), {1, 1}, {{0, 2}, {1, 1}}, {Vector(2, 0.0)}, 1e-12, options(), 1);
  EXPECT_EQ(result.status, Status::infeasible);
}

TEST_P(Mpgp, not_a_number_in_the_operator_ends)
{
  const Matrix A      = diagonal({1, std::nan("")});
  const auto   result = run_mpgp(A, {1, 1}, {{0, 0}, {1, 1}}, {Vector(2, 0.5)}, 1e-12, options(), 1);
  EXPECT_EQ(result.status, Status::stagnated);
}

TEST_P(Mpgp, unreachable_accuracy_ends_as_stagnation_at_the_solution)
{
  Random       random(5);
  const Matrix A      = random.semidefinite(10, 10, 0.1);
  const Vector b      = random.vector(10);
  const auto   box    = random.box(10, false);
  const auto   result = run_mpgp(A, b, box, {Vector(10, 0.0)}, -1.0, options(), spectral_norm(A));
  EXPECT_EQ(result.status, Status::stagnated);
  EXPECT_LT(kkt_residual(A, result.x, b, box), 1e-12 * length(b));
}

TEST_P(Mpgp, iteration_limit_is_kept)
{
  Random       random(6);
  const Matrix A         = random.semidefinite(30, 30, 1e-4);
  auto         limited   = options();
  limited.max_iterations = 3;
  const auto result =
    run_mpgp(A, random.vector(30), random.box(30, true, 100), {Vector(30, 0.0)}, 1e-12, limited, spectral_norm(A));
  EXPECT_EQ(result.status, Status::iteration_limit);
}

TEST_P(Mpgp, far_too_small_norm_still_converges)
{
  for (unsigned int seed = 0; seed < 30; ++seed)
    {
      Random       random(seed);
      const Matrix A      = random.semidefinite(10, 10, 0.05);
      const Vector b      = random.vector(10, 3);
      const auto   box    = random.box(10, false);
      const double norm   = spectral_norm(A);
      const auto   result = run_mpgp(A, b, box, {Vector(10, 0.0)}, 1e-10, options(), 0.01 * norm);
      EXPECT_EQ(result.status, Status::converged) << seed;
      EXPECT_LT(kkt_residual(A, result.x, b, box), 1e-9) << seed;
      EXPECT_LT(result.norm, 1.2 * norm) << seed;
    }
}

TEST_P(Mpgp, returned_gradient_is_that_of_the_returned_point)
{
  Random       random(7);
  const Matrix A      = random.semidefinite(15, 15, 0.01);
  const Vector b      = random.vector(15);
  const auto   box    = random.box(15, false);
  const auto   result = run_mpgp(A, b, box, {Vector(15, 0.0)}, 1e-8, options(), spectral_norm(A));
  EXPECT_LT(distance(result.gradient, gradient(A, result.x, b)), 1e-12);
  EXPECT_NEAR(result.projected_gradient, kkt_residual(A, result.x, b, box), 1e-12);
}

TEST_P(Mpgp, warm_start_with_gradient_costs_no_multiplication)
{
  Random       random(8);
  const Matrix A     = random.semidefinite(10, 10, 0.1);
  const Vector b     = random.vector(10);
  const auto   box   = random.box(10, false);
  const double norm  = spectral_norm(A);
  const auto   first = run_mpgp(A, b, box, {Vector(10, 0.0)}, 1e-9, options(), norm);
  const auto   again = run_mpgp(A, b, box, {first.x, first.gradient}, 1e-9, options(), norm);
  EXPECT_GT(first.counts.hessian_multiplications, 0u);
  EXPECT_EQ(again.counts.hessian_multiplications, 0u);
  EXPECT_EQ(again.status, Status::converged);
  EXPECT_EQ(again.x, first.x);
}

TEST_P(Mpgp, gradient_of_a_start_outside_of_the_box_is_not_trusted)
{
  Random       random(9);
  const Matrix A   = random.semidefinite(6, 6, 0.1);
  const Vector b   = random.vector(6);
  const auto   box = random.box(6, true);
  const Vector far(6, 10.0);
  const auto   result = run_mpgp(A, b, box, {far, gradient(A, far, b)}, 1e-10, options(), spectral_norm(A));
  EXPECT_EQ(result.status, Status::converged);
  EXPECT_LT(kkt_residual(A, result.x, b, box), 1e-9);
}

TEST_P(Mpgp, counter_equals_the_number_of_calls_of_the_operator)
{
  for (unsigned int seed = 0; seed < 20; ++seed)
    {
      Random       random(seed);
      const Matrix A     = random.semidefinite(12, 12, 0.01);
      const Vector b     = random.vector(12);
      const auto   box   = random.box(12, false);
      unsigned int calls = 0;
      const auto   count = [&](const Vector &v, Vector &Av) {
        ++calls;
        Av = A * v;
      };
      const auto stop = [](const Vector &, const double gP) { return gP <= 1e-9; };
      const auto result =
        mpgp(count, spectral_norm(A), b, box, MpgpStart<Vector>{random.vector(12)}, stop, options(), SerialReduction());
      EXPECT_EQ(result.counts.hessian_multiplications, calls);
    }
}

TEST_P(Mpgp, tracker_follows_a_linear_function_of_the_point)
{
  struct Tracker
  {
    double of_x = 0, of_v = 0;
    void   stepped(const double a)
    {
      of_x -= a * of_v;
    }
    void moved_towards(const double a)
    {
      of_x += a * (of_v - of_x);
    }
  };
  for (unsigned int seed = 0; seed < 50; ++seed)
    {
      Random       random(seed);
      const Matrix A = random.semidefinite(12, 12, 0.01);
      const Vector b = random.vector(12, 5), weights = random.vector(12);
      const auto   box = random.box(12, false);
      Tracker      tracker;
      const auto   multiply = [&](const Vector &v, Vector &Av) {
        tracker.of_v = inner(weights, v);
        Av           = A * v;
      };
      const auto stop   = [](const Vector &, const double gP) { return gP <= 1e-9; };
      const auto result = mpgp(multiply,
                               spectral_norm(A),
                               b,
                               box,
                               MpgpStart<Vector>{Vector(12, 0.0)},
                               stop,
                               options(),
                               SerialReduction(),
                               tracker);
      EXPECT_EQ(result.status, Status::converged) << seed;
      EXPECT_NEAR(tracker.of_x, inner(weights, result.x), 1e-12) << seed;
    }
}
