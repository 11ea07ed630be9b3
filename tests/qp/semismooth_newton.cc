// Semismooth Newton: enumeration of active sets, bounds that follow other entries, problems without a solution.
#include "faced_problem.h"

#include <slipstick/qp/semismooth_newton.h>

using namespace slipstick::qp;
using namespace slipstick::qp::test;

namespace
{
  struct Instance
  {
    Instance(const unsigned int seed, const std::size_t n, const std::size_t m)
      : random(seed)
      , problem(random.semidefinite(n, n, 0.5), random.orthonormal(m, n), random.vector(m, 0.3))
      , d(random.vector(n))
    {
      const double norm = spectral_norm(problem.F);
      for (double &entry : problem.F.entries)
        entry /= norm;
    }

    NewtonResult<Vector> solve(const AdmissibleSet<Vector> &set) const
    {
      return semismooth_newton(problem, 1., d, set, NewtonStart<Vector>{Vector(d.size(), 0.)}, Goal(1e-10, 1.));
    }

    /// Largest violation of G x = e.
    double imbalance(const Vector &x) const
    {
      return length(minus(problem.G * x, problem.e));
    }

    Random       random;
    FacedProblem problem;
    Vector       d;
  };

  /// Entries in threes: one without bounds, one normal, one tangential.
  struct Contact : Instance
  {
    Contact(const unsigned int seed, const std::size_t nodes, const double coefficient, const double fixed)
      : Instance(seed, 3 * nodes, 2)
      , set{{Vector(3 * nodes, -infinity), Vector(3 * nodes, infinity)}, {}}
    {
      for (std::size_t k = 0; k < nodes; ++k)
        {
          set.box.lower[3 * k + 1] = 0;
          set.pressure_bounds.push_back({3 * k + 2, 3 * k + 1, fixed, coefficient});
        }
    }

    /// By how much x and F x - d + G'a miss the laws of contact and friction, a from the entries without bounds.
    double violation(const Vector &x) const
    {
      std::vector<bool> unbounded(x.size());
      for (std::size_t i = 0; i < x.size(); ++i)
        unbounded[i] = i % 3 == 0;
      Vector g = minus(problem.F * x, d), w = g;
      problem.face(unbounded, {}).multiplier_shift(g, w);
      add(-1., w, g);
      double worst = 0;
      for (const PressureBound &bound : set.pressure_bounds)
        {
          const double n = x[bound.normal], t = x[bound.tangential];
          const double radius = n > 0 ? bound.fixed + bound.coefficient * n : 0.;
          worst               = std::max({worst, std::abs(g[bound.normal - 1]), -n, std::abs(t) - radius});
          worst               = std::max(worst, n > 0 ? std::abs(g[bound.normal]) : -g[bound.normal]);
          if (radius > 0)
            worst = std::max(worst,
                             std::abs(t) < radius ? std::abs(g[bound.tangential])
                             : t > 0              ? g[bound.tangential]
                                                  : -g[bound.tangential]);
        }
      return worst;
    }

    AdmissibleSet<Vector> set;
  };
} // namespace

TEST(SemismoothNewton, agrees_with_the_enumeration_of_all_active_sets)
{
  unsigned int n_solved = 0;
  for (unsigned int seed = 0; seed < 200; ++seed)
    {
      Instance   p(seed, 5, 1);
      const auto box   = p.random.box(5, true);
      const auto exact = enumerate(p.problem.F, p.d, p.problem.G, p.problem.e, box);
      const auto found = p.solve({box, {}});
      if (found.status != Status::converged)
        continue;
      ++n_solved;
      ASSERT_TRUE(exact) << seed;
      EXPECT_LT(distance(found.x, *exact), 1e-8) << seed;
      EXPECT_TRUE(is_within(box, found.x)) << seed;
    }
  EXPECT_GT(n_solved, 100u); // the others need the safeguard: no solution, or a set that holds nothing
}

TEST(SemismoothNewton, bounds_that_follow_the_pressure_are_met)
{
  for (const double coefficient : {0., 0.1, 0.3})
    for (const double fixed : {0., 0.05})
      {
        unsigned int n_solved = 0, n_slip = 0, n_stick = 0, n_open = 0;
        for (unsigned int seed = 0; seed < 100; ++seed)
          {
            const Contact p(seed, 4, coefficient, fixed);
            const auto    found = p.solve(p.set);
            if (found.status != Status::converged)
              continue;
            ++n_solved;
            EXPECT_LT(p.violation(found.x), 1e-8) << seed;
            EXPECT_LT(p.imbalance(found.x), 1e-8) << seed;
            for (const auto &bound : p.set.pressure_bounds)
              {
                const double n = found.x[bound.normal], t = std::abs(found.x[bound.tangential]);
                ++(!(n > 0) ? n_open : t < fixed + coefficient * n ? n_stick : n_slip);
              }
          }
        EXPECT_GE(n_solved, 95u) << coefficient << ", " << fixed;
        EXPECT_GT(n_slip, 20u) << coefficient << ", " << fixed;
        EXPECT_GT(n_open, 20u) << coefficient << ", " << fixed;
        EXPECT_TRUE(n_stick > 0 || coefficient + fixed == 0) << coefficient << ", " << fixed;
      }
}

TEST(SemismoothNewton, differentiated_bounds_lead_where_followed_ones_do)
{
  unsigned int n_compared = 0;
  for (unsigned int seed = 0; seed < 50; ++seed)
    {
      const Contact         p(seed, 4, 0.2, 0.);
      const auto            found    = p.solve(p.set);
      AdmissibleSet<Vector> followed = {p.set.box, {}};
      for (const auto &bound : p.set.pressure_bounds)
        followed.box.lower[bound.tangential] = followed.box.upper[bound.tangential] = 0;
      double change = 1;
      Vector x;
      for (unsigned int k = 0; k < 200 && change > 1e-11; ++k)
        {
          const auto fixed = p.solve(followed);
          if (fixed.status != Status::converged)
            break;
          change = 0;
          x      = fixed.x;
          for (const auto &bound : p.set.pressure_bounds)
            {
              const double radius = bound.radius(x[bound.normal]);
              change              = std::max(change, std::abs(radius - followed.box.upper[bound.tangential]));
              followed.box.lower[bound.tangential] = -radius;
              followed.box.upper[bound.tangential] = radius;
            }
        }
      if (found.status == Status::converged && change <= 1e-11)
        {
          ++n_compared;
          EXPECT_LT(distance(found.x, x), 1e-7) << seed;
        }
    }
  EXPECT_GT(n_compared, 40u);
}

TEST(SemismoothNewton, ends_where_the_caller_accepts_and_returns_what_it_saw)
{
  unsigned int n_ended = 0;
  for (unsigned int seed = 0; seed < 20; ++seed)
    {
      const Contact            p(seed, 6, 0.3, 0.);
      unsigned int             n_asked = 0;
      std::vector<Vector>      asked;
      const Acceptance<Vector> accepts = [&](const Vector &x, const Vector &) {
        asked.push_back(x);
        return ++n_asked == 2;
      };
      const auto found = semismooth_newton(p.problem,
                                           1.,
                                           p.d,
                                           p.set,
                                           NewtonStart<Vector>{Vector(p.d.size(), 0.)},
                                           Goal(1e-14, 1.),
                                           {},
                                           {},
                                           accepts);
      if (found.status != Status::converged || n_asked < 2)
        continue;
      ++n_ended;
      EXPECT_EQ(n_asked, 2u) << seed;
      EXPECT_EQ(found.counts.outer_iterations, 2u) << seed;
      for (std::size_t i = 0; i < found.x.size(); ++i)
        if (found.free[i] && i % 3 == 0) // entries with bounds are moved to them
          EXPECT_EQ(found.x[i], asked.back()[i]) << seed;
    }
  EXPECT_GT(n_ended, 10u);
}

TEST(SemismoothNewton, the_gradient_of_the_solution_saves_the_search_for_its_set)
{
  const Contact p(3, 6, 0.3, 0.);
  const auto    found = p.solve(p.set);
  ASSERT_EQ(found.status, Status::converged);
  std::vector<bool> unbounded(p.d.size());
  for (std::size_t i = 0; i < unbounded.size(); ++i)
    unbounded[i] = i % 3 == 0;
  Vector g = minus(p.problem.F * found.x, p.d), w = g;
  p.problem.face(unbounded, {}).multiplier_shift(g, w);
  add(-1., w, g);
  const auto again = semismooth_newton(p.problem, 1., p.d, p.set, NewtonStart<Vector>{found.x, g}, Goal(1e-9, 1.));
  EXPECT_EQ(again.status, Status::converged);
  EXPECT_EQ(again.counts.outer_iterations, 1u);
  EXPECT_LT(distance(again.x, found.x), 1e-8);
}

TEST(SemismoothNewton, equalities_that_nothing_free_can_meet)
{
  Matrix F = diagonal({1, 1}), G(1, 2);
  G(0, 0)  = 1;
  const FacedProblem          problem(F, G, {1});
  const AdmissibleSet<Vector> set{{{0, -infinity}, {0, infinity}}, {}};
  const auto                  found =
    semismooth_newton(problem, 1., Vector{0, 1}, set, NewtonStart<Vector>{Vector{0, 0}}, Goal(1e-8, 1.));
  EXPECT_EQ(found.status, Status::infeasible);
}
