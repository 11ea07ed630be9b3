// PCPG: against a dense solve, preconditioners, starts, degenerate problems.
#include "support.h"

#include <slipstick/qp/pcpg.h>

using namespace slipstick::qp;
using namespace slipstick::qp::test;

namespace
{
  struct Instance
  {
    Instance(const unsigned int seed, const std::size_t n, const std::size_t m)
      : random(seed)
      , problem(random.semidefinite(n, n, 0.02), random.orthonormal(m, n))
      , b(random.vector(n))
    {}

    // x with G x = G start and P(b - F x) = 0
    Vector exact(const Vector &start) const
    {
      const std::size_t n = problem.F.n, m = problem.G.m;
      Matrix            K(n + m, n + m);
      Vector            rhs(b);
      for (std::size_t i = 0; i < n; ++i)
        for (std::size_t j = 0; j < n; ++j)
          K(i, j) = problem.F(i, j);
      for (std::size_t k = 0; k < m; ++k)
        for (std::size_t j = 0; j < n; ++j)
          K(j, n + k) = K(n + k, j) = problem.G(k, j);
      const Vector e = problem.G * start;
      rhs.insert(rhs.end(), e.begin(), e.end());
      Vector x = *solve(K, rhs);
      x.resize(n);
      return x;
    }

    Random       random;
    DenseProblem problem;
    Vector       b;
  };

  PcpgOptions with(const Reorthogonalization reorthogonalization)
  {
    PcpgOptions options;
    options.reorthogonalization = reorthogonalization;
    return options;
  }

  constexpr Reorthogonalization all[] = {Reorthogonalization::automatic,
                                         Reorthogonalization::full,
                                         Reorthogonalization::none};
} // namespace

TEST(Pcpg, agrees_with_a_dense_solve)
{
  for (const auto way : all)
    for (unsigned int seed = 0; seed < 50; ++seed)
      {
        const Instance p(seed, 20, seed % 5);
        const Vector   start(20, 0.0);
        const auto     result = pcpg(p.problem, p.b, PcpgStart<Vector>{start}, 1e-11, with(way));
        EXPECT_EQ(result.status, Status::converged) << seed;
        EXPECT_LT(distance(result.x, p.exact(start)), 1e-7) << seed;
      }
}

TEST(Pcpg, agrees_with_a_dense_solve_when_preconditioned)
{
  for (const auto way : all)
    for (unsigned int seed = 0; seed < 50; ++seed)
      {
        Instance     p(seed, 20, seed % 5);
        const Matrix M = p.random.semidefinite(20, 20, 0.1);
        const Vector start(20, 0.0);
        const auto   result =
          pcpg(p.problem, p.b, PcpgStart<Vector>{start}, 1e-11, with(way), [&](const Vector &r, Vector &y) {
            y = M * r;
          });
        EXPECT_EQ(result.status, Status::converged) << seed;
        EXPECT_LT(distance(result.x, p.exact(start)), 1e-7) << seed;
      }
}

TEST(Pcpg, keeps_the_range_part_of_the_start)
{
  Instance     p(1, 15, 3);
  const Vector start  = p.random.vector(15);
  const auto   result = pcpg(p.problem, p.b, PcpgStart<Vector>{start}, 1e-11);
  EXPECT_EQ(result.status, Status::converged);
  EXPECT_LT(distance(p.problem.range(result.x), p.problem.range(start)), 1e-12);
  EXPECT_LT(distance(result.x, p.exact(start)), 1e-7);
}

TEST(Pcpg, product_and_residual_are_those_of_the_returned_point)
{
  Instance   p(2, 15, 3);
  const auto result = pcpg(p.problem, p.b, PcpgStart<Vector>{p.random.vector(15)}, 1e-6);
  EXPECT_LT(distance(result.product, p.problem.F * result.x), 1e-11);
  EXPECT_LT(distance(result.residual, p.problem.kernel(minus(p.b, p.problem.F * result.x))), 1e-11);
  EXPECT_NEAR(result.relative_residual, length(result.residual) / length(p.b), 1e-15);
}

TEST(Pcpg, full_reorthogonalisation_solves_an_ill_conditioned_system_within_its_dimension)
{
  // Krylov space of dimension n: exact arithmetic ends after n steps, and kept directions restore that
  const std::size_t n = 60;
  Vector            d(n);
  for (std::size_t i = 0; i < n; ++i)
    d[i] = std::pow(10.0, -6.0 * static_cast<double>(i) / static_cast<double>(n - 1));
  const DenseProblem problem(diagonal(d), Matrix(0, n));
  const Vector       b(n, 1.0);
  PcpgOptions        options = with(Reorthogonalization::full);
  options.max_iterations     = n;
  EXPECT_EQ(pcpg(problem, b, PcpgStart<Vector>{Vector(n, 0.0)}, 1e-6, options).status, Status::converged);
}

TEST(Pcpg, counters_equal_the_calls)
{
  Instance     p(3, 20, 3);
  unsigned int calls = 0;
  const auto   result =
    pcpg(p.problem, p.b, PcpgStart<Vector>{p.random.vector(20)}, 1e-9, {}, [&](const Vector &r, Vector &y) {
      ++calls;
      y = r;
    });
  EXPECT_GT(calls, 0u);
  EXPECT_EQ(result.counts.preconditioner_applications, calls);
  EXPECT_EQ(result.counts.hessian_multiplications, p.problem.n_multiplications);
}

TEST(Pcpg, start_with_product_costs_no_multiplication)
{
  const Instance p(4, 20, 3);
  const auto     first  = pcpg(p.problem, p.b, PcpgStart<Vector>{Vector(20, 0.0)}, 1e-9);
  const auto     before = p.problem.n_multiplications;
  const auto     again  = pcpg(p.problem, p.b, PcpgStart<Vector>{first.x, first.product}, 1e-9);
  EXPECT_EQ(again.status, Status::converged);
  EXPECT_EQ(again.counts.hessian_multiplications, 0u);
  EXPECT_EQ(p.problem.n_multiplications, before);
}

TEST(Pcpg, zero_right_hand_side_returns_zero)
{
  const Instance p(5, 10, 2);
  const auto     result = pcpg(p.problem, Vector(10, 0.0), PcpgStart<Vector>{Vector(10, 0.0)}, 1e-9);
  EXPECT_EQ(result.status, Status::converged);
  EXPECT_EQ(result.x, Vector(10, 0.0));
}

TEST(Pcpg, consistent_semidefinite_system_converges)
{
  for (unsigned int seed = 0; seed < 30; ++seed)
    {
      Random             random(seed);
      const DenseProblem problem(random.semidefinite(15, 6, 0), random.orthonormal(2, 15));
      const Vector       b      = problem.F * problem.kernel(random.vector(15));
      const auto         result = pcpg(problem, b, PcpgStart<Vector>{Vector(15, 0.0)}, 1e-8);
      EXPECT_EQ(result.status, Status::converged) << seed;
      EXPECT_LT(length(problem.kernel(minus(b, problem.F * result.x))), 1e-7 * length(b)) << seed;
    }
}

TEST(Pcpg, inconsistent_system_does_not_converge)
{
  const DenseProblem problem(diagonal({1, 2, 0}), Matrix(0, 3));
  const auto         result = pcpg(problem, Vector{0, 0, 1}, PcpgStart<Vector>{Vector(3, 0.0)}, 1e-8);
  EXPECT_EQ(result.status, Status::infeasible);
}

TEST(Pcpg, preconditioner_that_annihilates_the_residual_ends)
{
  const Instance p(6, 10, 2);
  const auto     result =
    pcpg(p.problem, p.b, PcpgStart<Vector>{Vector(10, 0.0)}, 1e-8, {}, [](const Vector &, Vector &y) { set_zero(y); });
  EXPECT_EQ(result.status, Status::stagnated);
}

TEST(Pcpg, unreachable_accuracy_ends_at_the_solution)
{
  const Instance p(7, 20, 3);
  const auto     result = pcpg(p.problem, p.b, PcpgStart<Vector>{Vector(20, 0.0)}, 1e-30);
  EXPECT_EQ(result.status, Status::stagnated);
  EXPECT_LT(distance(result.x, p.exact(Vector(20, 0.0))), 1e-9);
}
