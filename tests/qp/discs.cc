// MPGP and SMALBE-M with discs (SMALSE-M) against the conditions of the solution.
#include "support.h"

#include <slipstick/qp/smalbe.h>

using namespace slipstick::qp;
using namespace slipstick::qp::test;

namespace
{
  /// Entries 0, 1 and 2, 3, ... of the first 2 n_discs are in discs, the others in a box.
  DiscBox<Vector> random_set(Random &random, const std::size_t n, const std::size_t n_discs, const double radius)
  {
    DiscBox<Vector> set{random.box(n, true), {}};
    for (std::size_t k = 0; k < n_discs; ++k)
      {
        const Vector center = random.vector(2);
        set.discs.push_back({2 * k, 2 * k + 1, radius * (1 + k % 3), {{0.1 * center[0], 0.1 * center[1]}}});
        for (const std::size_t i : {2 * k, 2 * k + 1})
          {
            set.box.lower[i] = -infinity;
            set.box.upper[i] = infinity;
          }
      }
    return set;
  }

  /// |x - projection of x - g|: 0 only at the solution, for every method.
  double natural_residual(const DiscBox<Vector> &set, const Vector &x, const Vector &g)
  {
    Vector moved = x;
    add(-1., g, moved);
    project(set, moved);
    return distance(moved, x);
  }

  bool is_inside(const DiscBox<Vector> &set, const Vector &x)
  {
    for (const Disc &disc : set.discs)
      if (std::hypot(x[disc.first] - disc.center[0], x[disc.second] - disc.center[1]) > (1 + 1e-14) * disc.radius)
        return false;
    for (std::size_t i = 0; i < x.size(); ++i)
      if (x[i] < set.box.lower[i] || x[i] > set.box.upper[i])
        return false;
    return true;
  }
} // namespace

class Discs : public testing::TestWithParam<Expansion>
{};

INSTANTIATE_TEST_SUITE_P(AllExpansions, Discs, testing::ValuesIn(all_expansions));

TEST_P(Discs, mpgp_meets_the_conditions_of_the_solution)
{
  unsigned int n_on_circle = 0, n_inside = 0;
  for (unsigned int seed = 0; seed < 60; ++seed)
    {
      Random            random(seed);
      const std::size_t n   = 12;
      const auto        A   = random.semidefinite(n, n, 0.05);
      const Vector      b   = random.vector(n);
      const auto        set = random_set(random, n, 4, seed % 2 ? 0.05 : 0.3);
      MpgpOptions       options;
      options.expansion = GetParam();
      const auto result = mpgp([&](const Vector &v, Vector &Av) { Av = A * v; },
                               spectral_norm(A),
                               b,
                               set,
                               MpgpStart<Vector>{random.vector(n)},
                               [](const Vector &, const double gP) { return gP <= 2e-8; },
                               options,
                               SerialReduction());
      ASSERT_EQ(result.status, Status::converged) << seed;
      Vector g = A * result.x;
      add(-1., b, g);
      EXPECT_TRUE(is_inside(set, result.x)) << seed;
      EXPECT_LT(natural_residual(set, result.x, g), 1e-7) << seed;
      for (const Disc &disc : set.discs)
        (detail::is_on_circle(disc, detail::from_center(disc, result.x)) ? n_on_circle : n_inside)++;
    }
  EXPECT_GT(n_on_circle, 50);
  EXPECT_GT(n_inside, 10);
}

TEST_P(Discs, smalbe_meets_the_conditions_of_the_solution)
{
  for (unsigned int seed = 0; seed < 40; ++seed)
    {
      Random            random(seed);
      const std::size_t n = 12, m = 2;
      DenseProblem      problem(random.semidefinite(n, n, 0.05), random.orthonormal(m, n));
      const double      norm = spectral_norm(problem.F);
      const Vector      b    = problem.kernel(random.vector(n));
      auto              set  = random_set(random, n, 4, 0.3);
      for (std::size_t i = 8; i < n; ++i) // there is a feasible point with G x = 0: all discs and bounds are around 0
        {
          set.box.lower[i] = std::min(set.box.lower[i], -0.1);
          set.box.upper[i] = std::max(set.box.upper[i], 0.1);
        }
      SmalbeOptions options;
      options.inner.expansion = GetParam();
      const auto result       = smalbe(problem, norm, b, set, SmalbeStart<Vector>{Vector(n, 0.)}, 1e-9, options);
      ASSERT_EQ(result.status, Status::converged) << seed;
      EXPECT_TRUE(is_inside(set, result.x)) << seed;
      Vector Qx(n), g(n);
      problem.project_range(result.x, Qx);
      EXPECT_LT(length(Qx), 1e-8) << seed;
      problem.multiply(result.x, g); // g becomes P F x - b + G'mu
      g = problem.kernel(g);
      add(-1., b, g);
      add(1., result.shift, g);
      EXPECT_LT(natural_residual(set, result.x, g), 1e-6) << seed;
    }
}

TEST(DiscBox, an_infeasible_set_is_told)
{
  // x0 + x1 = 0 is impossible if (x0, x1) is in a disc about (2, 0) of radius 1/2
  struct Problem
  {
    static void multiply(const Vector &x, Vector &y)
    {
      y = x;
    }
    static void project_range(const Vector &x, Vector &y)
    {
      y.assign(2, (x[0] + x[1]) / 2);
    }
    static SerialReduction reduction()
    {
      return {};
    }
  };
  const DiscBox<Vector> set{{Vector(2, -infinity), Vector(2, infinity)}, {{0, 1, 0.5, {{2, 0}}}}};
  const auto            result = smalbe(Problem(), 1., Vector{1, -1}, set, SmalbeStart<Vector>{Vector(2, 0.)}, 1e-10);
  EXPECT_EQ(result.status, Status::infeasible);
}
