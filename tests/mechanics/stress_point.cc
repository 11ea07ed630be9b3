#include "grid.h"

#include <slipstick/mechanics/stress_point.h>

using namespace slipstick;
using namespace slipstick::test;
using mechanics::StressPoint;
using scene::ElementKind;
using scene::PlaneState;

namespace
{
  using Stress = mechanics::Stress<2>;

  // in a cell, on an edge between strips, at a vertex inside, on the boundary, at a corner
  const std::vector<Point> points = {{0.31, 0.43}, {0.5, 0.3}, {0.375, 0.625}, {1, 0.4}, {0, 0}};

  double difference(const Stress &a, const Stress &b)
  {
    return (a - b).abs().maxCoeff() / b.abs().maxCoeff();
  }

  /// Sum over the ranks of the work of loads.
  double work(const OnGrid &grid, const std::vector<Eigen::VectorXd> &loads, const std::vector<Eigen::VectorXd> &u)
  {
    double sum = 0;
    for (unsigned int p = 0; p < u.size(); ++p)
      sum += loads[p].dot(u[p]);
    return dealii::Utilities::MPI::sum(sum, grid.comm);
  }

  Grid lattice(const Cells cells)
  {
    Grid grid;
    grid.cells  = cells;
    grid.n      = {{8, 8}};
    grid.strips = 4;
    return grid;
  }
} // namespace

TEST(StressPoint, uniform_stress)
{
  const Kind kinds[] = {{Cells::quadrilaterals, 1, ElementKind::standard},
                        {Cells::quadrilaterals, 2, ElementKind::standard},
                        {Cells::quadrilaterals, 1, ElementKind::nearly_incompressible},
                        {Cells::triangles, 1, ElementKind::standard},
                        {Cells::triangles, 2, ElementKind::standard}};
  for (const Kind &kind : kinds)
    for (const auto state : {PlaneState::plane_strain, PlaneState::plane_stress})
      {
        if (kind.element != ElementKind::standard && state == PlaneState::plane_stress)
          continue;
        SCOPED_TRACE(name(kind));
        Scene scene                  = sheet(kind.degree, state);
        scene.discretization.element = kind.element;
        const OnGrid          grid(scene, lattice(kind.cells));
        const Eigen::Matrix2d gradient = (Eigen::Matrix2d() << 1e-3, 4e-3, -2e-3, 3e-3).finished();
        const auto            u =
          grid.nodal([&](const Point &x) -> Eigen::Vector2d { return gradient * Eigen::Vector2d(x[0], x[1]); });
        const auto exact  = stress_of(scene, gradient).array().eval();
        const auto stress = grid.stress(u);
        for (const Point &x : points)
          {
            const StressPoint<2> point(scene, grid.mesh, grid.spaces, 0, x, 1.);
            const auto           fitted = point.fitted(u);
            ASSERT_TRUE(fitted);
            EXPECT_LT(difference(point.recovered(stress), exact), 1e-11);
            EXPECT_LT(difference(*fitted, exact), 1e-11);
            const Stress weights{0.3, -0.7, 0.2, 0.9};
            EXPECT_NEAR(work(grid, point.loads(weights), u), (weights * exact).sum(), 1e-11 * exact.abs().maxCoeff());
          }
      }
}

/// Stresses one degree higher than those of the element are fitted exactly, at boundaries, too. Recovered ones of
/// degree 1 are exact as well; of degree 2 those at boundaries are extrapolated linearly.
TEST(StressPoint, stresses_at_boundaries)
{
  const auto at_inside = [](const Point &x) { return x[0] > 0 && x[0] < 1 && x[1] > 0 && x[1] < 1; };
  for (const unsigned int degree : {1, 2})
    {
      SCOPED_TRACE(degree);
      const Scene  scene = sheet(degree);
      const OnGrid grid(scene, lattice(Cells::quadrilaterals));
      const auto   n      = degree;
      const auto   u      = grid.nodal([&](const Point &x) {
        return Eigen::Vector2d(1e-3 * std::pow(x[0] + 1, n + 1) + 2e-3 * std::pow(x[1], n + 1),
                               3e-3 * std::pow(x[0], n) * x[1]);
      });
      const auto   stress = grid.stress(u);
      for (const Point &x : points)
        {
          Eigen::Matrix2d gradient;
          gradient << 1e-3 * (n + 1) * std::pow(x[0] + 1, n), 2e-3 * (n + 1) * std::pow(x[1], n),
            3e-3 * n * std::pow(x[0], n - 1) * x[1], 3e-3 * std::pow(x[0], n);
          const auto           exact = stress_of(scene, gradient).array().eval();
          const StressPoint<2> point(scene, grid.mesh, grid.spaces, 0, x, 1.);
          const auto           fitted = point.fitted(u);
          ASSERT_TRUE(fitted);
          EXPECT_LT(difference(*fitted, exact), 1e-10) << x;
          EXPECT_LT(difference(point.recovered(stress), exact), degree == 1 || at_inside(x) ? 1e-12 : 0.005) << x;
        }
    }
}

TEST(StressPoint, too_few_cells)
{
  Grid grid          = lattice(Cells::quadrilaterals);
  grid.n             = {{4, 1}};
  grid.strips        = 4;
  const Scene  scene = sheet(1);
  const OnGrid on_grid(scene, grid);
  const auto   u = on_grid.nodal([](const Point &x) { return Eigen::Vector2d(x[0] * x[1], x[0]); });
  EXPECT_FALSE(StressPoint<2>(scene, on_grid.mesh, on_grid.spaces, 0, {0.5, 0}, 1.).fitted(u));
}

TEST(StressPoint, derivatives_of_the_von_mises_stress)
{
  const mechanics::Stress<3> s{10, -20, 7, 35, -4, 11};
  const auto                 d = mechanics::von_mises_derivatives<3>(s);
  for (unsigned int c = 0; c < 6; ++c)
    {
      mechanics::Stress<3> high = s, low = s;
      high[c] += 1e-4;
      low[c] -= 1e-4;
      EXPECT_NEAR(d[c], (mechanics::von_mises<3>(high) - mechanics::von_mises<3>(low)) / 2e-4, 1e-8);
    }
  EXPECT_EQ(mechanics::von_mises_derivatives<3>(mechanics::Stress<3>::Zero()).abs().maxCoeff(), 0);
}
