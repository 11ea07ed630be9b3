// Semismooth Newton: enumeration of active sets, bounds that follow other entries, problems without a solution.
#include "support.h"

#include <slipstick/qp/semismooth_newton.h>

using namespace slipstick::qp;
using namespace slipstick::qp::test;

namespace
{
  /// A dense problem with G x = e that can be looked at on its free and tied entries.
  struct FacedProblem : DenseProblem
  {
    FacedProblem(const Matrix &F_, const Matrix &G_, const Vector &e_)
      : DenseProblem(F_, G_)
      , e(e_)
    {}

    class Face
    {
    public:
      Face(const FacedProblem &problem_, const std::vector<bool> &free_, const std::vector<Tie> &ties_)
        : problem(problem_)
        , free(free_)
        , ties(ties_)
      {}

      void multiply(const Vector &x, Vector &y) const
      {
        problem.multiply(x, y);
      }

      const SerialReduction &reduction() const
      {
        return problem.reduction();
      }

      void project_range(const Vector &x, Vector &y) const
      {
        const Vector z = transposed(amplitudes(masked(x), false));
        for (std::size_t i = 0; i < x.size(); ++i)
          y[i] = free[i] ? z[i] : x[i];
      }

      void multiplier_shift(const Vector &v, Vector &y) const
      {
        y = transposed(amplitudes(masked(v), false));
      }

      void balance(Vector &x) const
      {
        move_by(minus(problem.e, problem.G * x), x);
      }

      void project_kernel(Vector &p) const
      {
        for (const Tie &tie : ties)
          p[tie.tied] = tie.factor * p[tie.to];
        Vector moving = masked(p);
        for (const Tie &tie : ties)
          moving[tie.tied] = p[tie.tied];
        Vector minus_Gp = problem.G * moving;
        for (double &entry : minus_Gp)
          entry = -entry;
        move_by(minus_Gp, p);
      }

      void precondition(const Vector &r, Vector &z) const
      {
        for (std::size_t i = 0; i < r.size(); ++i)
          z[i] = free[i] ? r[i] / problem.F(i, i) : 0.;
      }

      bool is_regular() const
      {
        return solve(gram(false), Vector(problem.G.m, 1.)).has_value();
      }

    private:
      Vector masked(Vector x) const
      {
        for (std::size_t i = 0; i < x.size(); ++i)
          x[i] = free[i] ? x[i] : 0.;
        return x;
      }

      // column i of G with what is tied to it
      double column(const std::size_t k, const std::size_t i, const bool with_ties) const
      {
        double value = problem.G(k, i);
        for (const Tie &tie : ties)
          if (with_ties && tie.to == i)
            value += tie.factor * problem.G(k, tie.tied);
        return value;
      }

      Matrix gram(const bool with_ties) const
      {
        Matrix A(problem.G.m, problem.G.m);
        for (std::size_t k = 0; k < A.m; ++k)
          for (std::size_t l = 0; l < A.m; ++l)
            for (std::size_t i = 0; i < free.size(); ++i)
              A(k, l) += free[i] ? column(k, i, with_ties) * column(l, i, with_ties) : 0.;
        return A;
      }

      Vector amplitudes(const Vector &x, const bool with_ties) const
      {
        return *solve(gram(with_ties), problem.G * x);
      }

      Vector transposed(const Vector &a) const
      {
        Vector y(free.size(), 0.);
        for (std::size_t k = 0; k < a.size(); ++k)
          for (std::size_t i = 0; i < y.size(); ++i)
            y[i] += problem.G(k, i) * a[k];
        return y;
      }

      // x += T y with the least y that changes G x by c
      void move_by(const Vector &c, Vector &x) const
      {
        const Vector a = *solve(gram(true), c);
        Vector       step(free.size(), 0.);
        for (std::size_t i = 0; i < free.size(); ++i)
          for (std::size_t k = 0; k < a.size() && free[i]; ++k)
            step[i] += column(k, i, true) * a[k];
        for (const Tie &tie : ties)
          step[tie.tied] = tie.factor * step[tie.to];
        add(1., step, x);
      }

      const FacedProblem &problem;
      std::vector<bool>   free;
      std::vector<Tie>    ties;
    };

    Face face(const std::vector<bool> &free, const std::vector<Tie> &ties) const
    {
      return Face(*this, free, ties);
    }

    Vector e;
  };

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

    NewtonResult<Vector> solve(const Box<Vector> &box, const CoupledBounds &coupled = {}) const
    {
      NewtonOptions options;
      return semismooth_newton(problem,
                               1.,
                               d,
                               box,
                               NewtonStart<Vector>{Vector(d.size(), 0.)},
                               Goal(1e-10, 1.),
                               options,
                               {},
                               {},
                               {},
                               coupled);
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
      , box{Vector(3 * nodes, -infinity), Vector(3 * nodes, infinity)}
    {
      for (std::size_t k = 0; k < nodes; ++k)
        {
          box.lower[3 * k + 1] = 0;
          coupled.bounds.push_back({3 * k + 2, 3 * k + 1, fixed, coefficient});
        }
      coupled.are_coupled = true;
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
      for (const PressureBound &bound : coupled.bounds)
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

    Box<Vector>   box;
    CoupledBounds coupled;
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
      const auto found = p.solve(box);
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
            const auto    found = p.solve(p.box, p.coupled);
            if (found.status != Status::converged)
              continue;
            ++n_solved;
            EXPECT_LT(p.violation(found.x), 1e-8) << seed;
            EXPECT_LT(p.imbalance(found.x), 1e-8) << seed;
            for (const auto &bound : p.coupled.bounds)
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
      const Contact p(seed, 4, 0.2, 0.);
      const auto    found = p.solve(p.box, p.coupled);
      Box<Vector>   box   = p.box;
      for (const auto &bound : p.coupled.bounds)
        box.lower[bound.tangential] = box.upper[bound.tangential] = 0;
      BoundUpdate<Vector> follow;
      follow.tolerance  = 1e-11;
      unsigned int left = 200;
      follow.update     = [&](const Vector &x) -> std::optional<double> {
        double change = 0, size = 0;
        for (const auto &bound : p.coupled.bounds)
          {
            const double radius         = bound.coefficient * std::max(x[bound.normal], 0.);
            change                      = std::max(change, std::abs(radius - box.upper[bound.tangential]));
            size                        = std::max(size, radius);
            box.lower[bound.tangential] = -radius;
            box.upper[bound.tangential] = radius;
          }
        if (left-- == 0)
          return {};
        return size > 0 ? change / size : 0.;
      };
      NewtonOptions options;
      const auto    followed = semismooth_newton(p.problem,
                                              1.,
                                              p.d,
                                              box,
                                              NewtonStart<Vector>{Vector(p.d.size(), 0.)},
                                              Goal(1e-10, 1.),
                                              options,
                                              {},
                                              {},
                                              follow);
      if (found.status == Status::converged && followed.status == Status::converged)
        {
          ++n_compared;
          EXPECT_LT(distance(found.x, followed.x), 1e-7) << seed;
        }
    }
  EXPECT_GT(n_compared, 40u);
}

TEST(SemismoothNewton, ends_where_the_caller_accepts_and_returns_what_it_saw)
{
  unsigned int n_ended = 0;
  for (unsigned int seed = 0; seed < 20; ++seed)
    {
      const Contact        p(seed, 6, 0.3, 0.);
      unsigned int         n_asked = 0;
      std::vector<Vector>  asked;
      NewtonOptions        options;
      Acceptance<Vector>   accepts = [&](const Vector &x, const Vector &) {
        asked.push_back(x);
        return ++n_asked == 2;
      };
      const auto found = semismooth_newton(p.problem,
                                           1.,
                                           p.d,
                                           p.box,
                                           NewtonStart<Vector>{Vector(p.d.size(), 0.)},
                                           Goal(1e-14, 1.),
                                           options,
                                           {},
                                           {},
                                           {},
                                           p.coupled,
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
  const auto    found = p.solve(p.box, p.coupled);
  ASSERT_EQ(found.status, Status::converged);
  std::vector<bool> unbounded(p.d.size());
  for (std::size_t i = 0; i < unbounded.size(); ++i)
    unbounded[i] = i % 3 == 0;
  Vector g = minus(p.problem.F * found.x, p.d), w = g;
  p.problem.face(unbounded, {}).multiplier_shift(g, w);
  add(-1., w, g);
  NewtonOptions options;
  const auto    again = semismooth_newton(p.problem,
                                       1.,
                                       p.d,
                                       p.box,
                                       NewtonStart<Vector>{found.x, g},
                                       Goal(1e-9, 1.),
                                       options,
                                       {},
                                       {},
                                       {},
                                       p.coupled);
  EXPECT_EQ(again.status, Status::converged);
  EXPECT_EQ(again.counts.outer_iterations, 1u);
  EXPECT_LT(distance(again.x, found.x), 1e-8);
}

TEST(SemismoothNewton, equalities_that_nothing_free_can_meet)
{
  Matrix F = diagonal({1, 1}), G(1, 2);
  G(0, 0)  = 1;
  const FacedProblem problem(F, G, {1});
  const Box<Vector>  box{{0, -infinity}, {0, infinity}};
  NewtonOptions      options;
  EXPECT_EQ(
    semismooth_newton(problem, 1., Vector{0, 1}, box, NewtonStart<Vector>{Vector{0, 0}}, Goal(1e-8, 1.), options)
      .status,
    Status::infeasible);
}
