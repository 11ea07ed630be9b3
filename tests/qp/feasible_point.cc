// Nearest feasible point: against enumeration, known answers, certificates.
#include "support.h"

#include <slipstick/qp/feasible_point.h>

using namespace slipstick::qp;
using namespace slipstick::qp::test;

namespace
{
  Matrix identity(const std::size_t n)
  {
    return diagonal(Vector(n, 1.0));
  }

  // r is in the range of Q, and r'x_e > max r'x over the box, except for unbounded entries, where r is tiny.
  void expect_certificate(const DenseProblem &problem, const Box<Vector> &box, const Vector &x_e, const Vector &r)
  {
    const double size = length(r);
    ASSERT_GT(size, 0);
    EXPECT_LT(distance(problem.range(r), r), 1e-9 * size);
    double support = 0;
    for (std::size_t i = 0; i < r.size(); ++i)
      {
        const double bound = r[i] > 0 ? box.upper[i] : box.lower[i];
        if (std::isfinite(bound))
          support += r[i] * bound;
        else
          EXPECT_LT(std::abs(r[i]), 1e-4 * size);
      }
    EXPECT_GT(inner(r, x_e), support);
  }
} // namespace

TEST(FeasiblePoint, agrees_with_the_enumeration_of_all_active_sets)
{
  unsigned int n_infeasible = 0, n_feasible = 0;
  for (unsigned int seed = 0; seed < 600; ++seed)
    {
      Random             random(seed);
      const std::size_t  n = 3 + seed % 3, m = 1 + seed % 2;
      const DenseProblem problem(identity(n), random.orthonormal(m, n));
      const auto         box    = random.box(n, seed % 2 == 0);
      const Vector       x_e    = random.vector(n, 1.2);
      const auto         exact  = enumerate(identity(n), Vector(n, 0.0), problem.G, problem.G * x_e, box);
      const auto         result = feasible_point(problem, x_e, box);
      EXPECT_TRUE(is_within(box, result.x)) << seed;
      if (exact)
        {
          ++n_feasible;
          EXPECT_EQ(result.status, Status::converged) << seed;
          EXPECT_LT(distance(result.x, *exact), 1e-8) << seed;
        }
      else
        {
          ++n_infeasible;
          EXPECT_EQ(result.status, Status::infeasible) << seed;
          expect_certificate(problem, box, x_e, result.certificate);
        }
    }
  EXPECT_GT(n_feasible, 100u);
  EXPECT_GT(n_infeasible, 100u);
}

TEST(FeasiblePoint, without_active_bounds_it_is_the_range_part)
{
  Random             random(1);
  const DenseProblem problem(identity(10), random.orthonormal(3, 10));
  const Vector       x_e    = random.vector(10);
  const auto         result = feasible_point(problem, x_e, {Vector(10, -infinity), Vector(10, infinity)});
  EXPECT_EQ(result.status, Status::converged);
  EXPECT_LT(distance(result.x, problem.range(x_e)), 1e-11);
}

TEST(FeasiblePoint, free_and_one_sided_entries)
{
  for (unsigned int seed = 0; seed < 100; ++seed)
    {
      Random             random(seed);
      const DenseProblem problem(identity(5), random.orthonormal(2, 5));
      const Box<Vector>  box{{0, 0, -infinity, -0.1, 0}, {infinity, infinity, infinity, 0.1, infinity}};
      const Vector       x_e    = random.vector(5);
      const auto         exact  = enumerate(identity(5), Vector(5, 0.0), problem.G, problem.G * x_e, box);
      const auto         result = feasible_point(problem, x_e, box);
      if (exact)
        {
          EXPECT_EQ(result.status, Status::converged) << seed;
          EXPECT_LT(distance(result.x, *exact), 1e-8) << seed;
        }
      else
        EXPECT_EQ(result.status, Status::infeasible) << seed;
    }
}

TEST(FeasiblePoint, larger_problems_hold_bounds_and_equalities)
{
  for (unsigned int seed = 0; seed < 30; ++seed)
    {
      Random             random(seed);
      const DenseProblem problem(identity(80), random.orthonormal(12, 80));
      const auto         box = random.box(80, false);
      Vector             inside(80); // a feasible point with many entries at their bounds
      for (std::size_t i = 0; i < 80; ++i)
        inside[i] = clip(random.uniform(-1, 1), box.lower[i], box.upper[i]);
      const auto result = feasible_point(problem, inside, box);
      EXPECT_EQ(result.status, Status::converged) << seed;
      EXPECT_TRUE(is_within(box, result.x)) << seed;
      EXPECT_LT(length(problem.range(minus(inside, result.x))), 1e-11 * length(inside)) << seed;
      EXPECT_LE(length(result.x), length(inside)) << seed;
    }
}

TEST(FeasiblePoint, larger_infeasible_problems_are_certified)
{
  // 20 equalities, 10 free entries: the bounded entries are far too small for the other 10 directions
  for (unsigned int seed = 0; seed < 30; ++seed)
    {
      Random             random(seed);
      const DenseProblem problem(identity(60), random.orthonormal(20, 60));
      auto               box = random.box(60, true, 0.01);
      for (std::size_t i = 0; i < 10; ++i)
        box.lower[i] = -(box.upper[i] = infinity);
      const Vector x_e    = random.vector(60);
      const auto   result = feasible_point(problem, x_e, box);
      EXPECT_EQ(result.status, Status::infeasible) << seed;
      expect_certificate(problem, box, x_e, result.certificate);
    }
}

TEST(FeasiblePoint, single_feasible_point_is_found)
{
  // sum of four entries = 4, all of them <= 1
  Matrix G(1, 4);
  G.entries = Vector(4, 0.5);
  const DenseProblem problem(identity(4), G);
  const auto         result = feasible_point(problem, Vector{4, 0, 0, 0}, {Vector(4, -1.0), Vector(4, 1.0)});
  EXPECT_EQ(result.status, Status::converged);
  EXPECT_LT(distance(result.x, Vector(4, 1.0)), 1e-11);
}

TEST(FeasiblePoint, barely_infeasible_is_certified)
{
  Matrix G(1, 4);
  G.entries = Vector(4, 0.5);
  const DenseProblem problem(identity(4), G);
  const Box<Vector>  box{Vector(4, -1.0), Vector(4, 1.0)};
  const Vector       x_e{4 + 1e-6, 0, 0, 0};
  const auto         result = feasible_point(problem, x_e, box);
  EXPECT_EQ(result.status, Status::infeasible);
  expect_certificate(problem, box, x_e, result.certificate);
}

TEST(FeasiblePoint, unilateral_contact_that_cannot_pull_is_certified)
{
  // two normal forces >= 0 must balance a force that lifts the body off
  Matrix G(1, 2);
  G.entries = Vector(2, std::sqrt(0.5));
  const DenseProblem problem(identity(2), G);
  const Box<Vector>  box{{0, 0}, {infinity, infinity}};
  const Vector       x_e{-3, 0};
  const auto         result = feasible_point(problem, x_e, box);
  EXPECT_EQ(result.status, Status::infeasible);
  expect_certificate(problem, box, x_e, result.certificate);
}

TEST(FeasiblePoint, zero_within_the_bounds_is_its_own_answer)
{
  Random             random(2);
  const DenseProblem problem(identity(6), random.orthonormal(2, 6));
  const auto         result = feasible_point(problem, Vector(6, 0.0), random.box(6, true));
  EXPECT_EQ(result.status, Status::converged);
  EXPECT_EQ(result.x, Vector(6, 0.0));
}

TEST(FeasiblePoint, contradicting_bounds_are_reported)
{
  const DenseProblem problem(identity(2), Random(3).orthonormal(1, 2));
  EXPECT_EQ(feasible_point(problem, Vector{1, 1}, {{0, 2}, {1, 1}}).status, Status::infeasible);
}

TEST(FeasiblePoint, does_not_depend_on_the_unit)
{
  const double unit = 1048576;
  for (unsigned int seed = 0; seed < 50; ++seed)
    {
      Random             random(seed);
      const DenseProblem problem(identity(10), random.orthonormal(3, 10));
      auto               box      = random.box(10, true);
      Vector             x_e      = random.vector(10);
      const auto         plain    = feasible_point(problem, x_e, box);
      Vector             expected = plain.x;
      for (Vector *v : {&x_e, &box.lower, &box.upper, &expected})
        for (double &entry : *v)
          entry *= unit;
      const auto scaled = feasible_point(problem, x_e, box);
      EXPECT_EQ(scaled.status, plain.status) << seed;
      EXPECT_EQ(scaled.x, expected) << seed;
    }
}

namespace
{
  // n/2 cones (0,1), (2,3), ... with random coefficients, a few of them 0.
  ForceSet<Vector> random_cones(Random &random, const std::size_t n)
  {
    ForceSet<Vector> set{{Vector(n, -infinity), Vector(n, infinity)}, {}};
    for (std::size_t i = 0; i + 1 < n; i += 2)
      set.nodes.push_back({i, i + 1, {0., std::max(0., random.uniform(-0.2, 1.0))}});
    return set;
  }

  Vector random_point(Random &random, const ForceSet<Vector> &set, const std::size_t n)
  {
    Vector x = random.vector(n);
    project(set, x);
    return x;
  }
} // namespace

TEST(ForceSet, projection_leaves_a_remainder_in_the_polar_cone)
{
  Random random(1);
  for (unsigned int k = 0; k < 200; ++k)
    {
      const auto   set = random_cones(random, 10);
      const Vector y   = random.vector(10);
      Vector       x(y);
      project(set, x);
      EXPECT_NEAR(inner(x, minus(y, x)), 0, 1e-14);
      for (const auto &cone : set.nodes)
        {
          EXPECT_LE(std::abs(x[cone.tangential]), cone.forces.coefficient * x[cone.normal] + 1e-15);
          const double t = y[cone.tangential] - x[cone.tangential], n = y[cone.normal] - x[cone.normal];
          EXPECT_LE(n + cone.forces.coefficient * std::abs(t), 1e-14);
        }
    }
}

TEST(ForceSet, derivative_is_that_of_the_projection)
{
  Random random(2);
  for (unsigned int k = 0; k < 100; ++k)
    {
      const auto   set = random_cones(random, 10);
      const Vector y = random.vector(10), p = random.vector(10);
      const double h = 1e-7;
      Vector       forward(y), backward(y), derivative(p);
      for (std::size_t i = 0; i < 10; ++i)
        {
          forward[i] += h * p[i];
          backward[i] -= h * p[i];
        }
      project(set, forward);
      project(set, backward);
      multiply_derivative(set, y, derivative);
      for (std::size_t i = 0; i < 10; ++i)
        EXPECT_NEAR(derivative[i], (forward[i] - backward[i]) / (2 * h), 1e-6) << k;
    }
}

namespace
{
  // n/3 nodes in space: cones, discs with cohesion, discs that follow no normal force (their third entry has no
  // bounds).
  ForceSet<Vector> random_discs(Random &random, const std::size_t n)
  {
    ForceSet<Vector> set{{Vector(n, -infinity), Vector(n, infinity)}, {}};
    for (std::size_t i = 0; i + 2 < n; i += 3)
      {
        const bool    follows = i % 9 != 0;
        const NodeSet forces{i % 2 == 0 || !follows ? random.uniform(0.1, 1.0) : 0.,
                             follows ? random.uniform(0.1, 1.0) : 0.};
        set.nodes.push_back({i, follows ? i + 2 : no_entry, forces, i + 1});
      }
    return set;
  }
} // namespace

TEST(ForceSet, discs_are_projected_on_and_differentiated_as_nearest_points)
{
  Random random(3);
  for (unsigned int k = 0; k < 100; ++k)
    {
      const auto   set = random_discs(random, 18);
      const Vector y = random.vector(18), p = random.vector(18);
      Vector       x(y), other              = random.vector(18);
      project(set, x);
      project(set, other);
      for (const auto &node : set.nodes)
        EXPECT_LE(std::hypot(x[node.tangential], x[node.second]),
                  node.forces.closed_radius(node.normal == no_entry ? 0. : x[node.normal]) + 1e-14);
      EXPECT_LE(inner(minus(y, x), minus(other, x)), 1e-13); // not acute: the set is convex, x is the nearest point
      const double h = 1e-6;
      Vector       forward(y), backward(y), derivative(p);
      for (std::size_t i = 0; i < 18; ++i)
        {
          forward[i] += h * p[i];
          backward[i] -= h * p[i];
        }
      project(set, forward);
      project(set, backward);
      multiply_derivative(set, y, derivative);
      for (std::size_t i = 0; i < 18; ++i)
        EXPECT_NEAR(derivative[i], (forward[i] - backward[i]) / (2 * h), 1e-5) << k;
    }
}

TEST(FeasiblePoint, in_discs_is_found_or_refuted)
{
  unsigned int n_infeasible = 0, n_undecided = 0; // close to the border of feasibility
  for (unsigned int seed = 0; seed < 60; ++seed)
    {
      Random             random(seed);
      const DenseProblem problem(identity(30), random.orthonormal(18, 30));
      const auto         set    = random_discs(random, 30);
      Vector             inside = random.vector(30);
      if (seed % 2 == 0)
        project(set, inside);
      const auto result = feasible_point(problem, inside, set);
      EXPECT_TRUE(seed % 2 == 1 || result.status == Status::converged) << seed;
      n_infeasible += result.status == Status::infeasible;
      n_undecided += result.status != Status::infeasible && result.status != Status::converged;
      if (result.status != Status::converged)
        continue;
      Vector there = result.x, left = result.x;
      project(set, there);
      EXPECT_LT(distance(there, result.x), 1e-12) << seed;
      problem.project_range(minus(result.x, inside), left);
      EXPECT_LT(length(left), 1e-10) << seed;
    }
  EXPECT_GT(n_infeasible, 3u);
  EXPECT_LE(n_undecided, 2u);
}

TEST(FeasiblePoint, in_friction_cones_is_the_nearest)
{
  for (unsigned int seed = 0; seed < 60; ++seed)
    {
      Random             random(seed);
      const DenseProblem problem(identity(40), random.orthonormal(6, 40));
      const auto         set    = random_cones(random, 40);
      const Vector       inside = random_point(random, set, 40);
      const auto         result = feasible_point(problem, inside, set);
      ASSERT_EQ(result.status, Status::converged) << seed;
      EXPECT_LT(length(problem.range(minus(inside, result.x))), 1e-11 * length(inside)) << seed;
      EXPECT_GE(inner(result.x, minus(inside, result.x)), -1e-9 * inner(inside, inside)) << seed; // obtuse angle
    }
}

TEST(FeasiblePoint, body_that_tips_over_its_edge_is_certified_also_near_the_limit)
{
  unsigned int n_undecided = 0;
  // Three rows balance a body on 20 points of a floor, at 0 .. 19; twelve others balance its parts, which ten free
  // entries glue together.
  for (unsigned int seed = 0; seed < 100; ++seed)
    {
      Random       random(seed);
      const Matrix parts = random.orthonormal(12, 50);
      Matrix       G(15, 50);
      auto         set = random_cones(random, 50);
      set.nodes.resize(20);
      for (std::size_t j = 0; j < 50; ++j)
        {
          for (std::size_t i = 0; i < 12; ++i)
            G(i + 3, j) = parts(i, j);
          if (j < 40)
            {
              G(j % 2, j) = 1;
              G(2, j)     = j % 2 == 1 ? double(j / 2) : 0.;
            }
        }
      const DenseProblem problem(identity(50), orthonormalized(G));
      const double       beyond = (seed % 2 == 0 ? -1 : 1) * std::pow(10., -1. - seed % 4); // of the weight
      Vector             x_e(50, 0.);
      x_e[39] = 1; // at 19, and pulled down or up at 0
      x_e[1]  = -beyond;
      for (std::size_t i = 40; i < 50; ++i)
        x_e[i] = random.uniform(-1, 1);
      for (PressureBound &node : set.nodes)
        node.forces.coefficient = 5;
      const auto result = feasible_point(problem, x_e, set);
      n_undecided += result.status != Status::infeasible && result.status != Status::converged;
      EXPECT_NE(result.status, beyond > 0 ? Status::converged : Status::infeasible) << seed;
      EXPECT_LT(length(result.x), 100 * length(x_e)) << seed;
    }
  EXPECT_LE(n_undecided, 4u); // of 100; their |beyond| is 1e-3 or 1e-4
}

TEST(FeasiblePoint, outside_of_friction_cones_is_certified)
{
  unsigned int n_infeasible = 0;
  for (unsigned int seed = 0; seed < 60; ++seed)
    {
      Random             random(seed);
      const DenseProblem problem(identity(20), random.orthonormal(8, 20));
      const auto         set    = random_cones(random, 20);
      const Vector       x_e    = random.vector(20);
      const auto         result = feasible_point(problem, x_e, set);
      if (result.status == Status::converged)
        continue;
      ASSERT_EQ(result.status, Status::infeasible) << seed;
      ++n_infeasible;
      const double along = inner(result.certificate, x_e);
      EXPECT_GT(along, 0) << seed;
      for (unsigned int k = 0; k < 100; ++k)
        {
          const Vector x = random_point(random, set, 20);
          EXPECT_LT(inner(result.certificate, x), 1e-3 * along * length(x) / length(x_e)) << seed;
        }
    }
  EXPECT_GT(n_infeasible, 10u);
}

namespace
{
  /// n/2 sets (0,1), (2,3), ...: with cohesion, capped, both, or the caps below the cohesion; a few without friction.
  ForceSet<Vector> random_polygons(Random &random, const std::size_t n)
  {
    ForceSet<Vector> set = random_cones(random, n);
    for (std::size_t k = 0; k < set.nodes.size(); ++k)
      {
        set.nodes[k].forces.fixed = k % 3 == 0 ? 0. : random.uniform(0.1, 1.0);
        if (k % 2 == 0)
          set.nodes[k].forces.cap = random.uniform(0.1, 2.0);
      }
    return set;
  }
} // namespace

TEST(ForceSet, projection_is_the_nearest_point_of_a_node_and_has_its_derivative)
{
  Random             random(3);
  std::array<int, 6> n_parts{};
  const double       h = 1e-7;
  for (unsigned int k = 0; k < 500; ++k)
    {
      const auto   set = random_polygons(random, 12);
      const Vector y = random.vector(12, 2.), p = random.vector(12);
      Vector       x(y), forward(y), backward(y), derivative(p);
      project(set, x);
      add(h, p, forward);
      add(-h, p, backward);
      project(set, forward);
      project(set, backward);
      multiply_derivative(set, y, derivative);
      for (const auto &node : set.nodes)
        {
          const std::size_t t = node.tangential, n = node.normal;
          ++n_parts[int(node.forces.part(y[t], y[n]))];
          EXPECT_GE(x[n], 0);
          EXPECT_LE(std::abs(x[t]), node.forces.closed_radius(x[n]) + 1e-14);
          for (unsigned int i = 0; i < 50; ++i) // an obtuse angle with the direction to any other point
            {
              double other_t = random.uniform(-3, 3), other_n = random.uniform(-1, 6);
              node.forces.project(other_t, other_n);
              EXPECT_LE((y[t] - x[t]) * (other_t - x[t]) + (y[n] - x[n]) * (other_n - x[n]), 1e-13);
            }
          EXPECT_NEAR(derivative[t], (forward[t] - backward[t]) / (2 * h), 1e-6);
          EXPECT_NEAR(derivative[n], (forward[n] - backward[n]) / (2 * h), 1e-6);
        }
    }
  for (const int n : n_parts)
    EXPECT_GT(n, 20);
}

TEST(ForceSet, support_is_the_largest_product_with_a_point_of_a_node)
{
  Random random(4);
  for (unsigned int k = 0; k < 300; ++k)
    {
      const auto   set = random_polygons(random, 12);
      const Vector r   = random.vector(12);
      for (const auto &node : set.nodes)
        {
          const double t = r[node.tangential], n = r[node.normal];
          const auto   support = node.forces.support(t, n);
          double       largest = -1e300;
          for (unsigned int i = 0; i < 100; ++i)
            {
              double other_t = random.uniform(-3, 3), other_n = random.uniform(-1, 6);
              node.forces.project(other_t, other_n);
              const double product = t * other_t + n * other_n;
              largest              = std::max(largest, product);
              EXPECT_LE(product, support.value + std::sqrt(support.unbounded) * std::hypot(other_t, other_n) + 1e-13);
            }
          double far_t = 1e6 * t, far_n = 1e6 * n; // projects onto the face where the product is largest
          node.forces.project(far_t, far_n);
          if (support.unbounded == 0)
            {
              EXPECT_NEAR(t * far_t + n * far_n, support.value, 1e-9);
            }
        }
    }
}

TEST(FeasiblePoint, within_the_shear_strength_of_nodes_is_found_or_refuted)
{
  unsigned int n_infeasible = 0;
  for (unsigned int seed = 0; seed < 60; ++seed)
    {
      Random             random(seed);
      const DenseProblem problem(identity(20), random.orthonormal(8, 20));
      const auto         set    = random_polygons(random, 20);
      const Vector       inside = random_point(random, set, 20);
      const Vector       x_e    = seed % 2 == 0 ? inside : random.vector(20, 2.);
      const auto         result = feasible_point(problem, x_e, set);
      Vector             there  = result.x;
      project(set, there);
      EXPECT_LT(distance(there, result.x), 1e-13 * length(x_e)) << seed;
      if (result.status == Status::converged)
        EXPECT_LT(length(problem.range(minus(x_e, result.x))), 1e-11 * length(x_e)) << seed;
      else
        {
          ASSERT_EQ(result.status, Status::infeasible) << seed;
          ++n_infeasible;
          const double along = inner(result.certificate, x_e);
          for (unsigned int k = 0; k < 100; ++k)
            EXPECT_LT(inner(result.certificate, random_point(random, set, 20)), along * (1 + 1e-9)) << seed;
        }
      EXPECT_TRUE(result.status == Status::converged || seed % 2 == 1) << seed;
    }
  EXPECT_GT(n_infeasible, 10u);
}
