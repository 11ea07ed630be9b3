#include "grid.h"

#include <deal.II/dofs/dof_tools.h>

using namespace slipstick;
using namespace slipstick::test;

namespace
{
  /// Gradient of a displacement.
  using Gradient = std::function<Eigen::Matrix2d(const Point &)>;

  /// Largest error of a recovered nodal stress over the largest stress, among the nodes that @p counts selects.
  double error(
    const OnGrid                             &grid,
    const Scene                              &scene,
    const std::vector<Eigen::VectorXd>       &u,
    const Gradient                           &gradient,
    const std::function<bool(const Point &)> &counts = [](const Point &) { return true; })
  {
    const auto stress = grid.stress(u);
    double     worst = 0, largest = 0;
    for (unsigned int p = 0; p < u.size(); ++p)
      {
        std::vector<Point> nodes(u[p].size());
        dealii::DoFTools::map_dofs_to_support_points(*grid.spaces.of(p).mapping, *grid.spaces.dof_handlers[p], nodes);
        for (unsigned int i = 0; i < stress.subdomains[p].nodal.rows(); ++i)
          if (const Point &x = nodes[2 * i]; counts(x))
            {
              const auto exact = stress_of(scene, gradient(x));
              worst   = std::max(worst, (stress.subdomains[p].nodal.row(i).transpose() - exact).cwiseAbs().maxCoeff());
              largest = std::max(largest, exact.cwiseAbs().maxCoeff());
            }
      }
    return dealii::Utilities::MPI::max(worst, grid.comm) / dealii::Utilities::MPI::max(largest, grid.comm);
  }

  Grid lattice(const Cells cells, const std::array<unsigned int, 2> &n)
  {
    Grid grid;
    grid.cells  = cells;
    grid.n      = n;
    grid.strips = 4;
    return grid;
  }

  Eigen::Vector2d quadratic(const Point &x)
  {
    return Eigen::Vector2d(1e-3 * x[0] * x[0] + 2e-3 * x[1] * x[1], 3e-3 * x[0] * x[1]);
  }

  Eigen::Matrix2d gradient_of_quadratic(const Point &x)
  {
    return (Eigen::Matrix2d() << 2e-3 * x[0], 4e-3 * x[1], 3e-3 * x[1], 3e-3 * x[0]).finished();
  }
} // namespace

/// Also at corners, and on slender oblique cells, where x and y of the points around a node are nearly linearly
/// dependent.
TEST(PatchRecovery, linear_stresses_of_degree_one)
{
  const std::function<Point(double, double)> maps[] = {
    [](const double s, const double t) { return Point(s, t); },
    [](const double s, const double t) { return Point(s - 0.01 * t, s + 0.01 * t); },
    [](const double s, const double t) { return Point(1e-3 * s + 4 * t, 7 * t); }};
  for (const auto &map : maps)
    {
      const Scene scene = sheet(1);
      Grid        grid  = lattice(Cells::quadrilaterals, {{8, 6}});
      grid.map          = map;
      const OnGrid on_grid(scene, grid);
      EXPECT_LT(error(on_grid, scene, on_grid.nodal(quadratic), gradient_of_quadratic), 1e-8);
    }
}

/// Inside the body; at its boundary the slope across it is that of the cells there.
TEST(PatchRecovery, quadratic_stresses_of_degree_two)
{
  const auto cubic = [](const Point &x) {
    return Eigen::Vector2d(1e-3 * x[0] * x[0] * x[1], 2e-3 * x[0] * x[1] * x[1] + 1e-3 * std::pow(x[1], 3));
  };
  const auto gradient = [](const Point &x) {
    return (Eigen::Matrix2d() << 2e-3 * x[0] * x[1],
            1e-3 * x[0] * x[0],
            2e-3 * x[1] * x[1],
            4e-3 * x[0] * x[1] + 3e-3 * x[1] * x[1])
      .finished();
  };
  const Scene  scene = sheet(2);
  const OnGrid grid(scene, lattice(Cells::quadrilaterals, {{8, 8}}));
  const auto   u      = grid.nodal(cubic);
  const auto   inside = [](const Point &x) {
    const double margin = 0.1; // a cell has 0.125
    return x[0] > margin && x[0] < 1 - margin && x[1] > margin && x[1] < 1 - margin;
  };
  EXPECT_LT(error(grid, scene, u, gradient, inside), 1e-11);
  EXPECT_LT(error(grid, scene, u, gradient), 0.002);
}

/// The slope across the layer is unknown; the slope along it is not, even where cells are much higher than long.
TEST(PatchRecovery, one_layer_of_cells)
{
  const auto u = [](const Point &x) { return Eigen::Vector2d(1e-3 * x[0] * x[0], 0); };
  const auto g = [](const Point &x) { return (Eigen::Matrix2d() << 2e-3 * x[0], 0, 0, 0).finished(); };
  for (const auto &[angle, height] : {std::pair(0., 0.05), {0.6, 0.05}, {0., 300.}, {0.6, 300.}})
    {
      const Scene  scene   = sheet(1);
      Grid         grid    = lattice(Cells::quadrilaterals, {{12, 1}});
      const double along_x = std::cos(angle), along_y = std::sin(angle);
      const auto   turn = [&](const double x, const double y) {
        return Point(along_x * x - along_y * y, along_y * x + along_x * y);
      };
      grid.map = [&, height = height](const double s, const double t) { return turn(s, height * t); };
      const Eigen::Matrix2d rotation = (Eigen::Matrix2d() << along_x, -along_y, along_y, along_x).finished();
      const auto            along    = [&](const Point &x) { return Point(along_x * x[0] + along_y * x[1], 0); };
      const OnGrid          on_grid(scene, grid);
      EXPECT_LT(error(on_grid,
                      scene,
                      on_grid.nodal([&](const Point &x) -> Eigen::Vector2d { return rotation * u(along(x)); }),
                      [&](const Point &x) -> Eigen::Matrix2d { return rotation * g(along(x)) * rotation.transpose(); }),
                height < 1 ? 1e-10 : 1e-5);
    }
}

/// Thick tube: the hoop stress at the bore, where cells lie on one side only.
TEST(PatchRecovery, converges_at_boundaries)
{
  const Scene scene = sheet(1);
  const auto  u     = [](const Point &x) -> Eigen::Vector2d { return 1e-3 * Eigen::Vector2d(x[0], x[1]) / x.square(); };
  const auto  gradient = [](const Point &x) -> Eigen::Matrix2d {
    const Eigen::Vector2d r(x[0], x[1]);
    return 1e-3 * (Eigen::Matrix2d::Identity() / x.square() - 2 * r * r.transpose() / (x.square() * x.square()));
  };
  for (const Cells cells : {Cells::quadrilaterals, Cells::triangles})
    {
      std::vector<double> errors;
      for (const unsigned int n : {8, 16})
        {
          Grid grid = lattice(cells, {{n, n}});
          grid.map  = [](const double s, const double t) {
            const double angle = std::acos(-1.) / 2 * (1 - s);
            return (1 + t) * Point(std::cos(angle), std::sin(angle));
          };
          const OnGrid on_grid(scene, grid);
          errors.push_back(error(on_grid, scene, on_grid.nodal(u), gradient));
        }
      EXPECT_LT(errors[0], 0.15);
      EXPECT_LT(errors[1], errors[0] / 2.5); // means of the cells halve
    }
}
