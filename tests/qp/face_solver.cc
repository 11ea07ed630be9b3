// Linear problems of faces with directions of earlier faces: dense systems, the store, both solvers.
#include "faced_problem.h"

#include <slipstick/qp/active_set.h>
#include <slipstick/qp/face_solver.h>

using namespace slipstick::qp;
using namespace slipstick::qp::test;

namespace
{
  /// A random problem. A face holds some of its entries at their values in the start, and ties some to others.
  struct Held
  {
    Held(const unsigned int seed, const std::size_t n, const std::size_t m)
      : random(seed)
      , problem(random.semidefinite(n, n, 0.5), random.orthonormal(m, n), random.vector(m))
      , d(random.vector(n))
    {}

    /// F of lower rank, with d in its range.
    static Held singular(const unsigned int seed, const std::size_t n, const std::size_t m, const std::size_t rank)
    {
      Held result(seed, n, m);
      result.problem.F = result.random.semidefinite(n, rank, 0.);
      result.d         = result.problem.F * result.random.vector(n);
      for (std::size_t i = 0; i < n; ++i)
        result.problem.compliances.push_back(1. + 0.1 * static_cast<double>(i));
      return result;
    }

    /// Starts from an x0 with G x0 = e, with its product; held entries and ties remain as there.
    FaceSolution<Vector> solve(const std::vector<std::size_t> &at_bounds,
                               const std::vector<Tie>         &ties,
                               DirectionStore<Vector>         &store,
                               const double                    target         = 1e-10,
                               const std::vector<Turn>        &turns          = {},
                               const double                    regularization = 0) const
    {
      std::vector<bool> free(d.size(), true);
      for (const std::size_t i : at_bounds)
        free[i] = false;
      for (const Tie &tie : ties)
        free[tie.tied] = false;
      const auto face       = problem.face(free, ties, turns);
      const auto conditions = [&](Vector p) {
        turn(turns, p);
        const Vector present = p;
        for (const Tie &tie : ties)
          p[tie.tied] -= tie.factor * present[tie.to];
        Vector values;
        for (std::size_t i = 0; i < free.size(); ++i)
          if (!free[i])
            values.push_back(p[i]);
        return values;
      };
      const FaceSolverOptions                options;
      const Vector                           x = start(free, ties, turns);
      FaceSolver<Vector, FacedProblem::Face> solver(face, d, store, conditions, options, turns, regularization);
      solver.start(x, problem.F * x, 0, center());
      return ties.empty() ? solver.solve_symmetric(target) : solver.solve_unsymmetric(target);
    }

    Vector start(const std::vector<bool> &free, const std::vector<Tie> &ties, const std::vector<Turn> &turns = {}) const
    {
      Vector x(d.size(), 0.);
      for (std::size_t i = 0; i < x.size(); ++i)
        x[i] = free[i] ? 0. : 0.1 * static_cast<double>(i);
      problem.face(free, ties, turns).balance(x);
      return x;
    }

    /// The force at which the regularisation has no strain.
    Vector center() const
    {
      Vector x(d.size());
      for (std::size_t i = 0; i < x.size(); ++i)
        x[i] = std::cos(static_cast<double>(i));
      return x;
    }

    /// The same by a direct solve: equations of held and tied entries state how these are bound, those of the others
    /// are F x + G'a = d with the regularisation; then G x = e.
    Vector exact(const std::vector<std::size_t> &at_bounds,
                 const std::vector<Tie>         &ties,
                 const double                    regularization = 0) const
    {
      const std::size_t n = d.size(), m = problem.G.m;
      Matrix            A(n + m, n + m);
      Vector            b(n + m, 0.);
      std::vector<bool> free(n, true);
      for (const std::size_t i : at_bounds)
        {
          free[i] = false;
          A(i, i) = 1;
          b[i]    = 0.1 * static_cast<double>(i);
        }
      for (const Tie &tie : ties) // increments are tied
        {
          free[tie.tied]        = false;
          A(tie.tied, tie.tied) = 1;
          A(tie.tied, tie.to)   = -tie.factor;
          b[tie.tied]           = 0.1 * static_cast<double>(tie.tied);
        }
      for (std::size_t i = 0; i < n; ++i)
        if (free[i])
          {
            for (std::size_t j = 0; j < n; ++j)
              A(i, j) = problem.F(i, j);
            for (std::size_t k = 0; k < m; ++k)
              A(i, n + k) = problem.G(k, i);
            const double compliance = regularization > 0 ? regularization * problem.compliances[i] : 0.;
            A(i, i) += compliance;
            b[i] = d[i] + compliance * center()[i];
          }
      for (std::size_t k = 0; k < m; ++k)
        {
          for (std::size_t j = 0; j < n; ++j)
            A(n + k, j) = problem.G(k, j);
          b[n + k] = problem.e[k];
        }
      Vector x = *::slipstick::qp::test::solve(A, b);
      x.resize(n);
      return x;
    }

    Random       random;
    FacedProblem problem;
    Vector       d;
  };

  SmallSymmetric small(const Matrix &A)
  {
    SmallSymmetric result(A.n);
    for (std::size_t i = 0; i < A.n; ++i)
      for (std::size_t j = 0; j < A.n; ++j)
        result(i, j) = A(i, j);
    return result;
  }

  const std::vector<Tie> tied{{2, 1, 0.4}, {5, 4, -0.3}};
} // namespace

TEST(PivotedCholesky, solves_consistent_singular_systems)
{
  for (unsigned int seed = 0; seed < 50; ++seed)
    for (const std::size_t rank : {1, 4, 9, 10})
      {
        Random       random(seed);
        Matrix       A     = random.semidefinite(10, rank, 0.);
        const Vector sizes = random.vector(10, 8.); // rows and columns of very different sizes
        for (std::size_t i = 0; i < 10; ++i)
          for (std::size_t j = 0; j < 10; ++j)
            A(i, j) *= std::exp(sizes[i] + sizes[j]);
        const Vector b = A * random.vector(10);
        Vector       diagonal(10);
        for (std::size_t i = 0; i < 10; ++i)
          diagonal[i] = A(i, i);
        const Vector x = PivotedCholesky(small(A), diagonal, 1e-12).solve(b);
        EXPECT_LT(distance(A * x, b), 1e-8 * length(b)) << seed << ", rank " << rank;
      }
}

TEST(DirectionStore, energies_are_those_of_the_directions_left)
{
  Random                 random(1);
  const Matrix           F = random.semidefinite(6, 6, 0.1);
  DirectionStore<Vector> store(4);
  std::vector<Vector>    all;
  for (unsigned int k = 0; k < 7; ++k)
    {
      all.push_back(random.vector(6));
      store.push(all.back(), F * all.back(), 0, nullptr, SerialReduction());
    }
  ASSERT_EQ(store.size(), 4u);
  for (std::size_t i = 0; i < 4; ++i)
    for (std::size_t j = 0; j < 4; ++j)
      EXPECT_NEAR(store.energy(i, j), inner(all[3 + i], F * all[3 + j]), 1e-12);
}

TEST(DirectionStore, as_many_combinations_as_the_rank_allows_vanish_on_the_conditions)
{
  for (unsigned int seed = 0; seed < 50; ++seed)
    for (const std::size_t n_conditions : {0, 1, 3, 8})
      {
        constexpr std::size_t  n = 8;
        Random                 random(seed);
        DirectionStore<Vector> store(n);
        for (std::size_t k = 0; k < n; ++k)
          {
            const Vector p = random.vector(12);
            store.push(p, p, 0, nullptr, SerialReduction());
          }
        const auto conditions = [n_conditions](const Vector &p) { return Vector(p.begin(), p.begin() + n_conditions); };
        const auto found      = admissible_combinations(store, conditions, SerialReduction());
        EXPECT_EQ(found.size(), n - n_conditions) << seed;
        Matrix gram(found.size(), found.size()); // of coefficients: regular if they are independent
        for (std::size_t a = 0; a < found.size(); ++a)
          {
            Vector p(12, 0.);
            for (std::size_t k = 0; k < n; ++k)
              add(found[a][k], store[k].p, p);
            EXPECT_LT(length(conditions(p)), 1e-11 * length(found[a])) << seed;
            for (std::size_t b = 0; b < found.size(); ++b)
              gram(a, b) = inner(found[a], found[b]);
          }
        EXPECT_TRUE(solve(gram, Vector(found.size(), 1.))) << seed;
      }
}

TEST(FaceSolver, agrees_with_a_dense_solve)
{
  for (unsigned int seed = 0; seed < 50; ++seed)
    for (const auto &ties : {std::vector<Tie>(), tied})
      {
        const Held             p(seed, 12, seed % 3);
        DirectionStore<Vector> store(100);
        const auto             found = p.solve({0, 7}, ties, store);
        EXPECT_EQ(found.status, Status::converged) << seed;
        EXPECT_LT(distance(found.x, p.exact({0, 7}, ties)), 1e-8) << seed << ", ties " << ties.size();
        EXPECT_LT(distance(found.product, p.problem.F * found.x), 1e-11) << seed;
      }
}

TEST(FaceSolver, a_regularised_singular_face_has_one_solution)
{
  for (unsigned int seed = 0; seed < 20; ++seed)
    for (const auto &ties : {std::vector<Tie>(), tied})
      {
        const Held             p = Held::singular(seed, 12, seed % 3, 6);
        DirectionStore<Vector> store(100);
        for (const double regularization : {1e-1, 1e-2}) // the second face starts with the directions of the first
          {
            const auto found = p.solve({0, 7}, ties, store, 1e-11, {}, regularization);
            EXPECT_EQ(found.status, Status::converged) << seed;
            EXPECT_LT(distance(found.x, p.exact({0, 7}, ties, regularization)), 1e-8)
              << seed << ", ties " << ties.size();
            EXPECT_LT(distance(found.product, p.problem.F * found.x), 1e-10) << seed;
          }
      }
}

TEST(FaceSolver, errors_of_stored_products_are_not_inherited)
{
  // Products of stored directions with errors of one per cent, as left by many combinations of directions.
  for (unsigned int seed = 0; seed < 20; ++seed)
    {
      Held                   p(seed, 12, 0);
      DirectionStore<Vector> store(100);
      for (unsigned int k = 0; k < 4; ++k)
        {
          const Vector direction = p.random.vector(12);
          Vector       product = p.problem.F * direction, error = p.random.vector(12);
          add(0.01 * length(product) / length(error), error, product);
          store.push(direction, product, 0.01 * length(product), nullptr, SerialReduction());
        }
      p.solve({}, tied, store, 1e-8);
      ASSERT_GT(store.size(), 4u);
      for (std::size_t j = 4; j < store.size(); ++j)
        EXPECT_LT(distance(store[j].Fp, p.problem.F * store[j].p), 1e-3 * length(store[j].Fp)) << seed << ", " << j;
    }
}

TEST(FaceSolver, products_are_those_of_F_where_that_is_nearly_singular)
{
  // Forces that F hardly distinguishes from zero, as on rows that nearly depend on each other: when directions are made
  // orthogonal to earlier ones, they lose digits of their products, and the next faces start with them.
  unsigned int n_converged = 0;
  for (unsigned int seed = 0; seed < 8; ++seed)
    {
      Held       p(seed, 40, seed % 3);
      const auto size = [](const std::size_t i) { return std::pow(10., -0.08 * static_cast<double>(i)); };
      for (std::size_t i = 0; i < p.d.size(); ++i)
        {
          p.d[i] *= size(i);
          for (std::size_t j = 0; j < p.d.size(); ++j)
            p.problem.F(i, j) *= size(i) * size(j);
        }
      DirectionStore<Vector> store(200);
      for (std::size_t k = 0; k < 12; ++k)
        {
          const double target = 1e-10;
          const auto   found  = p.solve({0, 30 + k % 5}, {{2 + k, 1 + k, 0.4}, {15 + k, 14 + k, -0.3}}, store, target);
          if (found.status != Status::converged)
            continue;
          ++n_converged;
          const double drift = distance(found.product, p.problem.F * found.x);
          EXPECT_LT(drift, target) << seed << ", face " << k;
        }
    }
  EXPECT_GT(n_converged, 40u); // of 96; without residual replacement all, but 44 with wrong residuals
}

TEST(FaceSolver, directions_satisfy_the_equalities_though_they_are_differences_of_others)
{
  for (unsigned int seed = 0; seed < 8; ++seed)
    {
      const Held             p(seed, 20, 3);
      DirectionStore<Vector> store(200);
      double                 factor = 0.4;
      for (unsigned int k = 0; k < 30; ++k, factor += 1e-7) // faces that hardly differ, as where nodes slip
        p.solve({0, 7}, {{2, 1, factor}, {5, 4, -factor}}, store, 1e-12);
      for (std::size_t j = 0; j < store.size(); ++j)
        EXPECT_LT(length(p.problem.G * store[j].p), 1e-13 * length(store[j].p)) << seed << ", direction " << j;
    }
}

TEST(FaceSolver, the_same_face_again_costs_no_multiplication)
{
  for (unsigned int seed = 0; seed < 20; ++seed)
    for (const auto &ties : {std::vector<Tie>(), tied})
      {
        const Held             p(seed, 12, 2);
        DirectionStore<Vector> store(100);
        EXPECT_GT(p.solve({0, 7}, ties, store, 1e-9).counts.hessian_multiplications, 3u) << seed;
        const auto again = p.solve({0, 7}, ties, store, 1e-8);
        EXPECT_EQ(again.counts.hessian_multiplications, 0u) << seed << ", ties " << ties.size();
        EXPECT_LT(distance(again.x, p.exact({0, 7}, ties)), 1e-6) << seed;
      }
}

TEST(FaceSolver, a_face_with_few_other_entries_costs_fewer_multiplications_than_from_nothing)
{
  for (unsigned int seed = 0; seed < 20; ++seed)
    for (const auto &ties : {std::vector<Tie>(), tied})
      {
        const Held             p(seed, 40, 2);
        DirectionStore<Vector> store(100), empty(100);
        p.solve({0, 7, 8}, ties, store);
        const auto reused = p.solve({0, 8, 20, 30}, ties, store), fresh = p.solve({0, 8, 20, 30}, ties, empty);
        EXPECT_LE(reused.counts.hessian_multiplications + 3, fresh.counts.hessian_multiplications)
          << seed << ", ties " << ties.size();
        EXPECT_LT(distance(reused.x, p.exact({0, 8, 20, 30}, ties)), 1e-8) << seed;
      }
}

TEST(FaceSolver, directions_of_a_face_with_slightly_other_turns_save_multiplications)
{
  const auto turned = [](const double angle) {
    return std::vector<Turn>{{3, 4, std::cos(angle), std::sin(angle), 0.2},
                             {10, 11, std::cos(angle), -std::sin(angle), 0.1}};
  };
  const std::vector<Tie> slipping{{3, 2, 0.4}, {10, 9, -0.3}};
  for (unsigned int seed = 0; seed < 20; ++seed)
    {
      const Held             p(seed, 40, 2);
      DirectionStore<Vector> store(100), empty(100);
      p.solve({0}, slipping, store, 1e-10, turned(0.3));
      const auto reused = p.solve({0}, slipping, store, 1e-7, turned(0.301)),
                 fresh  = p.solve({0}, slipping, empty, 1e-7, turned(0.301));
      EXPECT_EQ(reused.status, Status::converged) << seed;
      EXPECT_LE(reused.counts.hessian_multiplications + 5, fresh.counts.hessian_multiplications) << seed;
      EXPECT_LT(distance(reused.x, fresh.x), 1e-5) << seed;
      EXPECT_LT(distance(reused.product, p.problem.F * reused.x), 1e-10) << seed;
    }
}

// What remains of such combinations is rounding, also in the energies.
TEST(FaceSolver, combinations_that_cancel_do_no_harm)
{
  for (unsigned int seed = 0; seed < 20; ++seed)
    for (const auto &ties : {std::vector<Tie>(), tied})
      {
        Held                   p(seed, 12, 2);
        DirectionStore<Vector> store(100);
        p.solve({0, 7}, ties, store);
        const std::size_t n = store.size();
        for (std::size_t k = 0; k < n; ++k) // parts of them again, as left by cut steps
          {
            Vector part = store[k].p;
            for (double &entry : part)
              entry *= k % 2 == 0 ? 0.5 : 0.3;
            const Vector product = p.problem.F * part;
            store.push(part, product, 0, nullptr, SerialReduction());
          }
        for (const std::size_t other : {8, 9, 10})
          {
            const auto found = p.solve({0, other}, ties, store);
            EXPECT_LT(distance(found.product, p.problem.F * found.x), 1e-10) << seed << ", ties " << ties.size();
            EXPECT_LT(distance(found.x, p.exact({0, other}, ties)), 1e-8) << seed << ", ties " << ties.size();
          }
      }
}

namespace
{
  struct Unweighted
  {
    SerialReduction serial;

    const SerialReduction &reduction() const
    {
      return serial;
    }
  };
} // namespace

TEST(ActiveSet, natural_residual_is_zero_at_solutions_alone)
{
  const Unweighted                      problem;
  const Box<Vector>                     box{{0, -2, -2, -infinity, -9}, {infinity, 2, 2, infinity, 9}};
  detail::ActiveSet<Vector, Unweighted> set(problem, 2., {box, {{4, 0, 0.1, 0.5}}}, 3.);
  // pressed and slipping at the bound 0.1 + 0.5 * 4; at both ends of boxes; without bounds
  const Vector x{4, -2, 2, 7, -2.1}, g{0, 1, -3, 0, 2};
  EXPECT_EQ(set.natural_residual(x, g), 0.);
  EXPECT_EQ(set.natural_residual({0, 1, 2, 7, 0}, {5, 0, -3, 0, 2}), 0.); // open: no friction
  for (std::size_t i = 0; i < x.size(); ++i)
    {
      Vector moved = x, pulled = g;
      moved[i] += i == 0 || i == 3 ? 0. : i == 2 ? -0.1 : 0.1; // those with zero gradient may have any value
      pulled[i] += i == 1 || i == 4 ? -4. : i == 2 ? 4. : 0.1;
      EXPECT_TRUE(i == 0 || i == 3 || set.natural_residual(moved, g) > 0.01) << i;
      EXPECT_GT(set.natural_residual(x, pulled), 0.01) << i;
    }
}

TEST(ActiveSet, wrong_slip_counts_no_more_than_the_force_that_it_changes)
{
  const Unweighted                      problem;
  const NodeSet                         coulomb{0, 0.5};
  detail::ActiveSet<Vector, Unweighted> plane(problem, 2., {{{0, -9}, {infinity, 9}}, {{1, 0, coulomb}}}, 3.);
  const Vector                          weak{1e-12, -5e-13}, strong{1, -0.5};
  for (const auto &[x, most] : {std::pair<Vector, double>(weak, 2e-12), std::pair<Vector, double>(strong, 1.)})
    {
      plane.predict(x, {0, 1});
      ASSERT_EQ(plane.sides(), (detail::Sides{0, -1}));
      EXPECT_NEAR(plane.residuals(x, {0, -1})[0], most, 1e-12 * most);
    }
  detail::ActiveSet<Vector, Unweighted> space(problem, 2., {{{0, -9, -9}, {infinity, 9, 9}}, {{1, 0, coulomb, 2}}}, 3.);
  space.predict({1e-12, 5e-13, 0}, {0, -1, 0});
  ASSERT_EQ(space.sides(), (detail::Sides{0, 1, 1})); // the direction of so small a force is held
  EXPECT_LT(space.residuals({1e-12, 5e-13, 0}, {0, 1, 0})[0], 2.1e-12);
  space.predict({0, 0, 0}, {1, 0.3, 0.4}); // open
  space.release({false, true, false});     // to hold a body
  EXPECT_LT(space.residuals({0, 0, 0}, {1, 0, 0.4})[0], 1e-15);
  EXPECT_NEAR(space.residuals({0, 0, 0}, {1, 0.1, 0.4})[0], 0.1, 1e-12);
}

TEST(ActiveSet, entries_pass_from_bound_to_bound_by_way_of_the_inside)
{
  const Unweighted                      problem;
  detail::ActiveSet<Vector, Unweighted> set(problem, 1., {{{-1, -1}, {1, 1}}, {}}, 1.);
  EXPECT_TRUE(set.predict({-1, 0}, {1, 0}));
  EXPECT_EQ(set.sides(), (detail::Sides{-1, 0}));
  EXPECT_TRUE(set.predict({-1, 0}, {-9, -9})); // far beyond the other bound
  EXPECT_EQ(set.sides(), (detail::Sides{0, 1}));
  EXPECT_TRUE(set.predict({-1, 0}, {-9, -9}));
  EXPECT_EQ(set.sides(), (detail::Sides{1, 1}));
  EXPECT_FALSE(set.predict({-1, 0}, {-9, -9}));
}
