#include "grid.h"

#include <slipstick/base/exceptions.h>

#include <deal.II/grid/manifold_lib.h>

#include <numeric>

using namespace slipstick;
using namespace slipstick::test;
using scene::ElementKind;
using scene::PlaneState;

namespace
{
  const std::vector<Kind> standard  = {{Cells::quadrilaterals, 1, ElementKind::standard},
                                       {Cells::quadrilaterals, 2, ElementKind::standard},
                                       {Cells::triangles, 1, ElementKind::standard},
                                       {Cells::triangles, 2, ElementKind::standard}};
  const std::vector<Kind> projected = {{Cells::quadrilaterals, 1, ElementKind::nearly_incompressible},
                                       {Cells::quadrilaterals, 2, ElementKind::nearly_incompressible},
                                       {Cells::triangles, 2, ElementKind::nearly_incompressible}};

  std::vector<Kind> all_kinds()
  {
    auto kinds = standard;
    kinds.insert(kinds.end(), projected.begin(), projected.end());
    return kinds;
  }

  std::vector<PlaneState> states_of(const Kind &kind)
  {
    return kind.element == ElementKind::standard
             ? std::vector<PlaneState>{PlaneState::plane_stress, PlaneState::plane_strain}
             : std::vector<PlaneState>{PlaneState::plane_strain};
  }

  Scene sheet(const Kind &kind, const PlaneState state = PlaneState::plane_strain)
  {
    Scene scene                  = test::sheet(kind.degree, state);
    scene.discretization.element = kind.element;
    return scene;
  }

  Grid grid_of(const Kind &kind, const std::array<unsigned int, 2> &n, const unsigned int strips = 4)
  {
    Grid grid;
    grid.cells  = kind.cells;
    grid.n      = n;
    grid.strips = strips;
    grid.fan    = true;
    return grid;
  }

  /// The unit square with displaced inner vertices.
  std::function<Point(double, double)> distorted()
  {
    return [](const double s, const double t) {
      const double bump = s * (1 - s) * t * (1 - t);
      return Point(s + 0.6 * bump * std::sin(17 * s + 29 * t), t + 1.2 * bump * std::cos(23 * s - 31 * t));
    };
  }

  /// Applies the tractions of a uniform stress of the unit square.
  void load_uniformly(Scene &scene, const Eigen::Vector4d &s)
  {
    const auto pull = [&](const std::string &boundary, const double x, const double y) {
      load(scene, 0, boundary, "0", "0");
      scene.tractions.back().components = {{number(s[0] * x + s[2] * y), number(s[2] * x + s[1] * y)}};
    };
    pull("left", -1, 0);
    pull("right", 1, 0);
    pull("bottom", 0, -1);
    pull("top", 0, 1);
  }

  void hold_symmetrically(Scene &scene)
  {
    support(scene, 0, "left", "0", "");
    support(scene, 0, "bottom", "", "0");
  }

  void heat(Scene &scene, const std::string &change)
  {
    scene.temperatures.push_back({"warm", {0}, field(change)});
  }

  scene::BodyForce<2> body_force()
  {
    scene::BodyForce<2> force;
    force.name   = "force";
    force.bodies = {0};
    return force;
  }

  double modulus(const Scene &scene)
  {
    return scene.materials[0].young_modulus;
  }
} // namespace

TEST(Elements, uniform_strain_passes_the_patch_test_on_distorted_cells)
{
  Eigen::Matrix2d gradient;
  gradient << 1e-3, 2e-4, -7e-4, 5e-4;
  for (const Kind &kind : all_kinds())
    for (const PlaneState state : states_of(kind))
      {
        Scene      scene  = sheet(kind, state);
        const auto expect = stress_of(scene, gradient);
        load_uniformly(scene, expect);
        Grid grid = grid_of(kind, {{5, 4}}, 1);
        grid.map  = distorted();
        const OnGrid          patch(scene, grid, MPI_COMM_SELF);
        const auto            u      = patch.nodal([&](const Point &x) -> Eigen::Vector2d {
          return gradient * Eigen::Vector2d(x[0], x[1]) + Eigen::Vector2d(3e-4, -1e-4);
        });
        const Eigen::VectorXd forces = patch.matrices[0].stiffness.selfadjointView<Eigen::Lower>() * u[0];
        EXPECT_LT(relative_difference(forces, patch.matrices[0].load), 1e-12) << name(kind);
        const auto stress = patch.stress(u);
        EXPECT_LT(patch.stress_difference(stress, [&](const Point &) { return expect; }), 1e-12 * expect.norm())
          << name(kind);
        EXPECT_LT(stress.error_squared, 1e-24 * stress.energy_squared) << name(kind);
        const double energy =
          3 * (expect[0] * gradient(0, 0) + expect[1] * gradient(1, 1) + expect[2] * (gradient(0, 1) + gradient(1, 0)));
        EXPECT_NEAR(stress.energy_squared / energy, 1, 1e-12) << name(kind);
      }
}

TEST(Elements, uniform_stress_is_solved_for_across_subdomains)
{
  Eigen::Matrix2d gradient;
  gradient << 1e-3, 0, 0, 5e-4;
  for (const Kind &kind : all_kinds())
    {
      Scene      scene  = sheet(kind);
      const auto expect = stress_of(scene, gradient);
      load_uniformly(scene, expect);
      hold_symmetrically(scene);
      Grid grid = grid_of(kind, {{8, 4}});
      grid.map  = distorted();
      const OnGrid patch(scene, grid);
      const auto   u = patch.solve();
      EXPECT_LT(
        patch.difference(u, [&](const Point &x) -> Eigen::Vector2d { return gradient * Eigen::Vector2d(x[0], x[1]); }),
        1e-10)
        << name(kind);
      EXPECT_LT(patch.stress_difference(patch.stress(u), [&](const Point &) { return expect; }), 1e-10 * expect.norm())
        << name(kind);
    }
}

TEST(Elements, kernel_is_spanned_by_the_rigid_motions)
{
  for (const Kind &kind : all_kinds())
    {
      Grid grid = grid_of(kind, {{3, 3}}, 1);
      grid.map  = distorted();
      const OnGrid          patch(sheet(kind), grid, MPI_COMM_SELF);
      const Eigen::MatrixXd K = full(patch.matrices[0].stiffness);
      EXPECT_LT((K * patch.matrices[0].kernel).norm(), 1e-13 * K.norm() * patch.matrices[0].kernel.norm());
      const Eigen::VectorXd eigenvalues = tfeti::symmetric_eigenvalues(K);
      EXPECT_LT(eigenvalues.head(3).cwiseAbs().maxCoeff(), 1e-13 * eigenvalues.tail(1)[0]) << name(kind);
      EXPECT_GT(eigenvalues[3], 1e-4 * eigenvalues.tail(1)[0]) << name(kind);
    }
}

TEST(Elements, triangles_of_degree_one_refuse_to_be_nearly_incompressible)
{
  const Kind kind{Cells::triangles, 1, ElementKind::nearly_incompressible};
  const auto message = message_on_all_ranks<InputError>([&] { OnGrid(sheet(kind), grid_of(kind, {{4, 4}})); });
  EXPECT_NE(message.find("Discretization/Degree = 2"), std::string::npos);
}

TEST(Elements, curved_edges_follow_their_circles)
{
  for (const Cells cells : {Cells::quadrilaterals, Cells::triangles})
    for (const unsigned int degree : {1, 2})
      {
        Scene scene = sheet({cells, degree, ElementKind::standard});
        scene.body_forces.push_back(body_force());
        scene.body_forces[0].force[0] = field("1");
        const double area             = pi / 4 * (4 - 1) * 3;
        const auto   error            = [&](const unsigned int n) {
          return std::abs(OnGrid(scene, quarter_ring(1, 2, {{4 * n, n}}, cells, 4)).resultant()[0] / area - 1);
        };
        EXPECT_NEAR(std::log2(error(1) / error(2)), 2 * degree, 0.2) << "degree " << degree;
        EXPECT_NEAR(std::log2(error(2) / error(4)), 2 * degree, 0.1) << "degree " << degree;
      }
}

TEST(Elements, pressure_on_the_whole_outline_has_no_resultant)
{
  for (const Kind &kind : standard)
    {
      Scene scene = sheet(kind);
      load(scene, 0, "*", "0", "0");
      scene.tractions[0].pressure = field("7");
      EXPECT_LT(OnGrid(scene, quarter_ring(1, 2, {{8, 3}}, kind.cells, 4)).resultant().norm(), 1e-12);
      scene.tractions[0].where.boundary = "bottom"; // the inner arc, pressed outwards
      const Eigen::Vector3d force       = OnGrid(scene, quarter_ring(1, 2, {{8, 3}}, kind.cells, 4)).resultant();
      EXPECT_LT((force - 7 * 3 * Eigen::Vector3d(1, 1, 0)).norm(), 1e-12) << name(kind);
    }
}

TEST(Elements, hanging_bar_stretches_under_its_weight)
{
  // u_y = rho g / (2 E) (y^2 - 1) without lateral contraction, held at the top
  for (const Kind &kind : all_kinds())
    for (const PlaneState state : states_of(kind))
      {
        Scene scene                      = sheet(kind, state);
        scene.materials[0].poisson_ratio = 0;
        scene.body_forces.push_back(body_force());
        scene.body_forces[0].acceleration[1] = field("-9810");
        support(scene, 0, "top", "0", "0");
        const double strain = 2 * 9810. / modulus(scene);
        const auto   expect = [&](const Point &x) { return Eigen::Vector2d(0, strain / 2 * (x[1] * x[1] - 1)); };
        const OnGrid bar(scene, grid_of(kind, {{8, 4}}));
        const bool   nodally_exact = kind.degree == 2 || kind.cells == Cells::quadrilaterals;
        EXPECT_LT(bar.difference(bar.solve(), expect), nodally_exact ? 1e-10 : 2e-2) << name(kind);
      }
}

TEST(Elements, rotating_bar_stretches)
{
  // along x, from the axis at x = 0: u = rho omega^2 / (2 E) (x - x^3 / 3)
  for (const Kind &kind : standard)
    {
      Scene scene                      = sheet(kind);
      scene.materials[0].poisson_ratio = 0;
      scene.body_forces.push_back(body_force());
      scene.body_forces[0].angular_velocity = field("30*t");
      support(scene, 0, "left", "0", "");
      support(scene, 0, "bottom", "", "0");
      support(scene, 0, "top", "", "0");
      const double a      = 2 * 900 / modulus(scene);
      const auto   expect = [&](const Point &x) { // held along y at both ends
        return Eigen::Vector2d(a / 2 * (x[0] - x[0] * x[0] * x[0] / 3), a / 6 * (x[1] - x[1] * x[1] * x[1]));
      };
      const OnGrid bar(scene, grid_of(kind, {{16, 8}}));
      const bool   one_dimensional = kind.cells == Cells::quadrilaterals; // exact at the ends of its elements
      EXPECT_LT(bar.difference(bar.solve(), expect),
                one_dimensional && kind.degree == 1 ? 1e-10
                : kind.degree == 1                  ? 1e-2
                                                    : 1e-4)
        << name(kind);
    }
}

TEST(Elements, rotating_ring_of_plane_stress)
{
  const double a = 1, b = 2, omega = 30;
  for (const Kind &kind : standard)
    {
      Scene        scene = sheet(kind, PlaneState::plane_stress);
      const double E = modulus(scene), nu = scene.materials[0].poisson_ratio, k = (3 + nu) / 8 * 2 * omega * omega;
      scene.body_forces.push_back(body_force());
      scene.body_forces[0].angular_velocity = number(omega);
      support(scene, 0, "left", "0", "");
      support(scene, 0, "right", "", "0");
      const auto expect = [&](const Point &x) -> Eigen::Vector2d {
        const double r = x.norm(), r_2 = r * r;
        const double radial = k * (a * a + b * b - a * a * b * b / r_2 - r_2);
        const double hoop   = k * (a * a + b * b + a * a * b * b / r_2 - (1 + 3 * nu) / (3 + nu) * r_2);
        return (hoop - nu * radial) / E * Eigen::Vector2d(x[0], x[1]);
      };
      const auto error = [&](const unsigned int n) {
        const OnGrid ring(scene, quarter_ring(a, b, {{2 * n, n}}, kind.cells, 4));
        return ring.difference(ring.solve(), expect);
      };
      const double coarse = error(4), fine = error(8);
      EXPECT_LT(fine, kind.degree == 1 ? 8e-3 : 4e-5) << name(kind);
      EXPECT_GT(std::log2(coarse / fine), kind.degree == 1 ? 1.8 : 2.8) << name(kind);
    }
}

TEST(Elements, free_thermal_expansion_is_free_of_stress)
{
  for (const Kind &kind : all_kinds())
    for (const PlaneState state : states_of(kind))
      {
        Scene scene = sheet(kind, state);
        hold_symmetrically(scene);
        heat(scene, "20");
        heat(scene, "30*t");
        Grid grid           = grid_of(kind, {{8, 4}});
        grid.map            = distorted();
        const bool   held   = state == PlaneState::plane_strain; // along z
        const double strain = 1e-3 * 50, nu = scene.materials[0].poisson_ratio, size = modulus(scene) * strain;
        const OnGrid sheet(scene, grid);
        const auto   u = sheet.solve();
        EXPECT_LT(sheet.difference(u,
                                   [&](const Point &x) -> Eigen::Vector2d {
                                     return strain * (held ? 1 + nu : 1) * Eigen::Vector2d(x[0], x[1]);
                                   }),
                  1e-10)
          << name(kind);
        EXPECT_LT(sheet.stress_difference(sheet.stress(u),
                                          [&](const Point &) { return Eigen::Vector4d(0, 0, 0, held ? -size : 0); }),
                  1e-10 * size)
          << name(kind);
      }
}

TEST(Elements, linear_change_of_temperature_is_free_of_stress_with_degree_two)
{
  for (const Kind &kind : all_kinds())
    if (kind.degree == 2 && !(kind.cells == Cells::triangles && kind.element == ElementKind::nearly_incompressible))
      for (const PlaneState state : states_of(kind))
        {
          Scene scene = sheet(kind, state);
          support(scene, 0, "left", "0", "");
          support(scene, 0, "bottom", "", "0");
          heat(scene, "100*(x+0)*0 + 40"); // uniform part
          heat(scene, "70*(x-0.3)");
          // u_x = c (40 x + 35 x^2 - 21 x - 35 y^2), u_y = c (40 + 70 (x - 0.3)) y: left and bottom bend and are held
          // accordingly
          const double c      = 1e-3 * (state == PlaneState::plane_strain ? 1 + scene.materials[0].poisson_ratio : 1);
          const auto   expect = [&](const Point &x) {
            return Eigen::Vector2d(c * (19 * x[0] + 35 * x[0] * x[0] - 35 * x[1] * x[1]), c * (19 + 70 * x[0]) * x[1]);
          };
          scene.supports[0].components[0] = field(std::to_string(-35 * c * 1e9) + "e-9*y*y");
          const OnGrid sheet(scene, grid_of(kind, {{8, 3}}));
          const auto   u = sheet.solve();
          EXPECT_LT(sheet.difference(u, expect), 1e-9) << name(kind);
          const auto stress = sheet.stress(u);
          EXPECT_LT(stress.error_squared, 1e-16 * std::pow(modulus(scene) * 0.1, 2)) << name(kind);
          double in_plane = 0;
          for (const auto &subdomain : stress.subdomains)
            in_plane = std::max(in_plane, subdomain.nodal.leftCols(3).cwiseAbs().maxCoeff());
          EXPECT_LT(in_plane, 1e-8 * modulus(scene) * 0.1) << name(kind);
        }
}

TEST(Elements, clamped_bar_is_pressed_by_heat)
{
  for (const Kind &kind : all_kinds())
    for (const PlaneState state : states_of(kind))
      {
        Scene scene = sheet(kind, state);
        support(scene, 0, "left", "0", "");
        support(scene, 0, "right", "0", "");
        support(scene, 0, "bottom", "", "0");
        heat(scene, "50");
        const double nu = scene.materials[0].poisson_ratio, size = modulus(scene) * 1e-3 * 50;
        const auto   expect = state == PlaneState::plane_stress
                                ? Eigen::Vector4d(-size, 0, 0, 0)
                                : Eigen::Vector4d(-size / (1 - nu), 0, 0, -size / (1 - nu));
        const OnGrid bar(scene, grid_of(kind, {{8, 4}}));
        EXPECT_LT(bar.stress_difference(bar.stress(bar.solve()), [&](const Point &) { return expect; }), 1e-9 * size)
          << name(kind);
      }
}

namespace
{
  /// Relative error of the displacement of a thick-walled cylinder under inner pressure (Lame), plane strain.
  double cylinder_error(const Kind &kind, const double nu, const unsigned int n)
  {
    // all diagonals have the same direction: triangles whose diagonals alternate lock less
    const double a = 1, b = 2, pressure = 10;
    Scene        scene               = sheet(kind);
    scene.materials[0].poisson_ratio = nu;
    load(scene, 0, "bottom", "0", "0");
    scene.tractions[0].pressure = number(pressure);
    support(scene, 0, "left", "0", "");
    support(scene, 0, "right", "", "0");
    const double c    = (1 + nu) / modulus(scene) * pressure * a * a / (b * b - a * a);
    Grid         grid = quarter_ring(a, b, {{2 * n, n}}, kind.cells, 4);
    grid.fan          = false;
    const OnGrid ring(scene, grid);
    return ring.difference(ring.solve(), [&](const Point &x) -> Eigen::Vector2d {
      return c * ((1 - 2 * nu) + b * b / x.norm_square()) * Eigen::Vector2d(x[0], x[1]);
    });
  }
} // namespace

TEST(NearlyIncompressible, thick_walled_cylinder_does_not_lock)
{
  for (const Kind &kind : projected)
    for (const double nu : {0.3, 0.4999, 0.49999})
      {
        const double coarse = cylinder_error(kind, nu, 4), fine = cylinder_error(kind, nu, 8);
        EXPECT_LT(fine, kind.degree == 1 ? 5e-3 : 1e-3) << name(kind) << ", nu = " << nu;
        EXPECT_GT(std::log2(coarse / fine), 1.7) << name(kind) << ", nu = " << nu;
      }
}

TEST(NearlyIncompressible, standard_elements_of_degree_one_lock_on_the_cylinder)
{
  for (const Kind &kind : standard)
    if (kind.degree == 1)
      {
        EXPECT_LT(cylinder_error(kind, 0.3, 8), 1.5e-2) << name(kind);
        EXPECT_GT(cylinder_error(kind, 0.49999, 8), 0.3) << name(kind);
      }
}

namespace
{
  /// Smooth solution that vanishes at the boundary of the unit square: energy norm of the error, relative.
  double energy_error(const Kind &kind, const unsigned int n, double &estimate)
  {
    Scene scene = sheet(kind, PlaneState::plane_stress);
    for (const std::string boundary : {"left", "right", "bottom", "top"})
      support(scene, 0, boundary, "0", "0");
    // u_x = u_y = 1e-3 sin(pi x) sin(pi y)
    const double E = modulus(scene), nu = scene.materials[0].poisson_ratio;
    const double mu = E / (2 * (1 + nu)), lambda = E * nu / (1 - nu * nu);
    scene.body_forces.push_back(body_force());
    char text[200];
    std::snprintf(text,
                  sizeof text,
                  "%.17g*sin(pi*x)*sin(pi*y) - %.17g*cos(pi*x)*cos(pi*y)",
                  1e-3 * pi * pi * (lambda + 3 * mu),
                  1e-3 * pi * pi * (lambda + mu));
    scene.body_forces[0].force = {{field(text), field(text)}};
    const double exact         = 1e-6 * pi * pi / 2 * (lambda + 3 * mu) * 3;
    Grid         grid          = grid_of(kind, {{n, n}});
    const OnGrid square(scene, grid);
    const auto   stress = square.stress(square.solve());
    const double error  = (exact - stress.energy_squared) / exact;
    estimate            = std::sqrt(stress.error_squared / exact);
    return std::sqrt(error);
  }
} // namespace

TEST(Elements, energy_norm_converges_at_the_rate_of_the_degree)
{
  for (const Kind &kind : standard)
    {
      double       estimate;
      const double coarse = energy_error(kind, 8, estimate), fine = energy_error(kind, 16, estimate);
      EXPECT_NEAR(std::log2(coarse / fine), kind.degree, 0.1) << name(kind);
      EXPECT_NEAR(estimate / fine, 1, 0.2) << name(kind);
    }
}

namespace
{
  /// Displacement error of a smooth isochoric solution at nu = 0.4999.
  double isochoric_error(const Kind &kind, const unsigned int n)
  {
    Scene scene                      = sheet(kind);
    scene.materials[0].poisson_ratio = 0.4999;
    scene.solver.tolerance           = 1e-8;
    for (const std::string boundary : {"left", "right", "bottom", "top"})
      support(scene, 0, boundary, "0", "0");
    // u = curl of sin^2(pi x) sin^2(pi y) / pi: sin^2(pi x) sin(2 pi y), -sin(2 pi x) sin^2(pi y); f = -mu lap u
    const double k = modulus(scene) / (2 * 1.4999) * pi * pi;
    scene.body_forces.push_back(body_force());
    const std::string factor   = std::to_string(k);
    scene.body_forces[0].force = {{field(factor + "*sin(2*pi*y)*(4*sin(pi*x)^2 - 2*cos(2*pi*x))"),
                                   field("-" + factor + "*sin(2*pi*x)*(4*sin(pi*y)^2 - 2*cos(2*pi*y))")}};
    const OnGrid square(scene, grid_of(kind, {{n, n}}));
    return square.difference(square.solve(), [&](const Point &x) {
      const double s = std::sin(pi * x[0]), t = std::sin(pi * x[1]);
      return Eigen::Vector2d(s * s * std::sin(2 * pi * x[1]), -std::sin(2 * pi * x[0]) * t * t);
    });
  }
} // namespace

TEST(NearlyIncompressible, smooth_isochoric_flow_converges)
{
  for (const Kind &kind : projected)
    {
      const double coarse = isochoric_error(kind, 8), fine = isochoric_error(kind, 16);
      const bool   full = kind.degree == 2 && kind.cells == Cells::quadrilaterals;
      EXPECT_LT(fine, full ? 2e-3 : 5e-2) << name(kind);
      EXPECT_GT(std::log2(coarse / fine), full ? 2.8 : 1.8) << name(kind);
    }
  EXPECT_GT(isochoric_error(standard[0], 16), 0.5);
}

namespace
{
  void pull_at(Scene &scene, const Point &x)
  {
    scene::PointLoad<2> load;
    load.name              = "pull";
    load.where.coordinates = x;
    load.force             = {{field("3"), field("-4*t + x")}};
    scene.point_loads.push_back(load);
  }
} // namespace

TEST(PointLoads, act_once_at_the_nearest_node)
{
  for (const Kind &kind : standard)
    for (const Point x : {Point(0.5, 0.5), Point(0.52, 0.26), Point(1, 1), Point(0.125, 0.1251)})
      {
        Scene scene = sheet(kind);
        pull_at(scene, x);
        const double fine = 4. * kind.degree; // nodes per length along y; twice along x
        const double at_x = std::round(x[0] * 2 * fine) / (2 * fine), at_y = std::round(x[1] * fine) / fine;
        const double f_y = -4 + at_x;
        EXPECT_LT(
          (OnGrid(scene, grid_of(kind, {{8, 4}})).resultant() - Eigen::Vector3d(3, f_y, at_x * f_y - at_y * 3)).norm(),
          1e-12)
          << name(kind) << " at " << x;
      }
}

TEST(PointLoads, outside_of_the_body_are_refused)
{
  Scene scene = sheet(standard[0]);
  pull_at(scene, {1.2, 0.5});
  const auto message = message_on_all_ranks<InputError>([&] { OnGrid(scene, grid_of(standard[0], {{8, 4}})); });
  EXPECT_NE(message.find("Point load pull: the point (1.2, 0.5) is not on body 'box': the nearest node, (1, 0.5)"),
            std::string::npos)
    << message;
}

namespace
{
  /// The largest difference of integrals of a function of the barycentric coordinates over their permutations.
  template <int dim>
  double asymmetry(const dealii::Quadrature<dim> &rule)
  {
    std::array<unsigned int, dim + 1> order;
    std::iota(order.begin(), order.end(), 0u);
    double least = HUGE_VAL, most = -HUGE_VAL;
    do
      {
        double sum = 0;
        for (unsigned int q = 0; q < rule.size(); ++q)
          {
            std::array<double, dim + 1> L{{1}};
            for (unsigned int d = 0; d < dim; ++d)
              {
                L[d + 1] = rule.point(q)[d];
                L[0] -= L[d + 1];
              }
            double f = rule.weight(q);
            for (unsigned int i = 0; i <= dim; ++i)
              f *= std::pow(L[order[i]] + 0.01, 1 + 2 * i);
            sum += f;
          }
        least = std::min(least, sum);
        most  = std::max(most, sum);
    } while (std::next_permutation(order.begin(), order.end()));
    return (most - least) / most;
  }

  template <int dim>
  void expect_symmetric_rules()
  {
    const dealii::ReferenceCell cell =
      dim == 2 ? dealii::ReferenceCells::Triangle : dealii::ReferenceCells::Tetrahedron;
    for (const unsigned int degree : {1, 2})
      {
        const mechanics::Element<dim> element(cell, degree);
        for (const auto *rule : {&element.stiffness, &element.loads, &element.stress})
          EXPECT_LT(asymmetry(*rule), 1e-13) << dim << ' ' << degree;
        for (const unsigned int n : {1, 2, 3, 4})
          EXPECT_LT(asymmetry(element.cell_quadrature(n)), 1e-13) << dim << ' ' << n;
        if constexpr (dim == 3)
          {
            for (const unsigned int n : {1, 2, 3, 4})
              EXPECT_LT(asymmetry(element.face_quadrature(n)), 1e-13) << n;
          }
      }
    // exact for squares: the integral of x^2 and of x y
    const auto rule = mechanics::Element<dim>(cell, 2).cell_quadrature(2);
    double     xx = 0, xy = 0;
    for (unsigned int q = 0; q < rule.size(); ++q)
      {
        xx += rule.weight(q) * rule.point(q)[0] * rule.point(q)[0];
        xy += rule.weight(q) * rule.point(q)[0] * rule.point(q)[1];
      }
    EXPECT_NEAR(xx, dim == 2 ? 1. / 12 : 1. / 60, 1e-15);
    EXPECT_NEAR(xy, dim == 2 ? 1. / 24 : 1. / 120, 1e-15);
  }
} // namespace

/// Those of deal.II with n = 2 are not.
TEST(Quadrature, on_simplices_does_not_depend_on_the_order_of_the_corners)
{
  expect_symmetric_rules<2>();
  expect_symmetric_rules<3>();
}
