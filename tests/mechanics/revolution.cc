#include "grid.h"

#include <slipstick/base/exceptions.h>
#include <slipstick/mechanics/spaces.h>
#include <slipstick/mechanics/surface.h>
#include <slipstick/mesh/kinematics.h>

using namespace slipstick;
using namespace slipstick::test;
using scene::ElementKind;
using scene::PlaneState;

namespace
{
  const std::vector<Kind> kinds = {{Cells::quadrilaterals, 1, ElementKind::standard},
                                   {Cells::quadrilaterals, 2, ElementKind::standard},
                                   {Cells::triangles, 1, ElementKind::standard},
                                   {Cells::triangles, 2, ElementKind::standard},
                                   {Cells::quadrilaterals, 1, ElementKind::nearly_incompressible},
                                   {Cells::quadrilaterals, 2, ElementKind::nearly_incompressible},
                                   {Cells::triangles, 2, ElementKind::nearly_incompressible}};

  Scene tube(const Kind &kind)
  {
    Scene scene                  = test::sheet(kind.degree, PlaneState::axisymmetric);
    scene.bodies[0].thickness    = 1;
    scene.discretization.element = kind.element;
    return scene;
  }

  /// Section from radius @p a to a + width, height 1; distorted inside.
  Grid section(const Kind                        &kind,
               const std::array<unsigned int, 2> &n,
               const double                       a,
               const double                       width,
               const unsigned int                 strips,
               const bool                         is_distorted = true)
  {
    Grid grid;
    grid.cells  = kind.cells;
    grid.n      = n;
    grid.strips = strips;
    grid.fan    = true;
    grid.map    = [=](const double s, const double t) {
      const double bump = is_distorted ? s * (1 - s) * t * (1 - t) : 0.;
      return Point(a + width * (s + 0.6 * bump * std::sin(17 * s + 29 * t)),
                   t + 1.2 * bump * std::cos(23 * s - 31 * t));
    };
    return grid;
  }

  void load_uniformly(Scene &scene, const double radial, const double axial, const bool has_bore)
  {
    const auto pull = [&](const std::string &boundary, const double x, const double y) {
      load(scene, 0, boundary, "0", "0");
      scene.tractions.back().components = {{number(radial * x), number(axial * y)}};
    };
    if (has_bore)
      pull("left", -1, 0);
    pull("right", 1, 0);
    pull("bottom", 0, -1);
    pull("top", 0, 1);
  }
} // namespace

TEST(Revolution, uniform_radial_hoop_and_axial_stress_pass_the_patch_test)
{
  const double e_r = 1e-3, e_z = -4e-4;
  for (const Kind &kind : kinds)
    for (const double a : {0., 2.})
      {
        Scene                 scene = tube(kind);
        const double          E = scene.materials[0].young_modulus, nu = scene.materials[0].poisson_ratio;
        const double          mu = E / (2 * (1 + nu)), lambda = 2 * mu * nu / (1 - 2 * nu), trace = 2 * e_r + e_z;
        const Eigen::Vector4d expect(lambda * trace + 2 * mu * e_r,
                                     lambda * trace + 2 * mu * e_z,
                                     0,
                                     lambda * trace + 2 * mu * e_r);
        load_uniformly(scene, expect[0], expect[1], a > 0);
        const auto state = [&](const Point &x) { return Eigen::Vector2d(e_r * x[0], e_z * x[1] + 2e-4); };
        {
          const OnGrid          patch(scene, section(kind, {{5, 4}}, a, 1.5, 1), MPI_COMM_SELF);
          const auto            u      = patch.nodal(state);
          const Eigen::VectorXd forces = patch.matrices[0].stiffness.selfadjointView<Eigen::Lower>() * u[0];
          EXPECT_LT(relative_difference(forces, patch.matrices[0].load), 1e-12) << name(kind) << ", bore " << a;
          const auto stress = patch.stress(u);
          EXPECT_TRUE(stress.has_hoop_stress);
          EXPECT_LT(patch.stress_difference(stress, [&](const Point &) { return expect; }), 1e-11 * expect.norm())
            << name(kind) << ", bore " << a;
          const double volume = pi * (std::pow(a + 1.5, 2) - a * a);
          EXPECT_NEAR(stress.energy_squared / (volume * (2 * expect[0] * e_r + expect[1] * e_z)), 1, 1e-12)
            << name(kind);
          EXPECT_LT(stress.error_squared, 1e-22 * stress.energy_squared) << name(kind);
        }
        // torn, with only the rows of the axis: u_y is held at the bottom
        scene.tractions.erase(scene.tractions.end() - 2);
        support(scene, 0, "bottom", "", "2e-4");
        const OnGrid torn(scene, section(kind, {{8, 4}}, a, 1.5, 4));
        const auto   u = torn.solve();
        EXPECT_LT(torn.difference(u, state), 1e-10) << name(kind) << ", bore " << a;
        EXPECT_LT(torn.stress_difference(torn.stress(u), [&](const Point &) { return expect; }), 1e-9 * expect.norm())
          << name(kind) << ", bore " << a;
      }
}

TEST(Revolution, only_the_axial_translation_is_rigid)
{
  for (const Kind &kind : kinds)
    for (const double a : {0., 5.})
      {
        const OnGrid          patch(tube(kind), section(kind, {{3, 3}}, a, 1, 1), MPI_COMM_SELF);
        const Eigen::MatrixXd K = full(patch.matrices[0].stiffness);
        ASSERT_EQ(patch.matrices[0].kernel.cols(), 1);
        EXPECT_LT((K * patch.matrices[0].kernel).norm(), 1e-13 * K.norm() * patch.matrices[0].kernel.norm());
        const Eigen::VectorXd eigenvalues = tfeti::symmetric_eigenvalues(K);
        EXPECT_LT(std::abs(eigenvalues[0]), 1e-13 * eigenvalues.tail(1)[0]) << name(kind);
        EXPECT_GT(eigenvalues[1], 1e-6 * eigenvalues.tail(1)[0]) << name(kind);
      }
}

TEST(Revolution, a_radial_displacement_of_a_ring_has_the_energy_of_its_hoop_strain)
{
  // u_r = 1: sigma : eps = (lambda + 2 mu) / r^2; the section from radius 2 to 3, height 1
  const Kind   kind{Cells::quadrilaterals, 2, ElementKind::standard};
  const OnGrid ring(tube(kind), section(kind, {{8, 2}}, 2, 1, 1), MPI_COMM_SELF);
  const auto   u = ring.nodal([](const Point &) { return Eigen::Vector2d(1, 0); })[0];
  const double E = ring.scene.materials[0].young_modulus, nu = ring.scene.materials[0].poisson_ratio;
  const double modulus = E * (1 - nu) / ((1 + nu) * (1 - 2 * nu));
  const double energy  = u.dot(ring.matrices[0].stiffness.selfadjointView<Eigen::Lower>() * u);
  EXPECT_NEAR(energy / (2 * pi * modulus * std::log(1.5)), 1, 1e-8);
}

TEST(Revolution, thick_tube_under_pressure_follows_lame)
{
  // u_r = A r + B / r, plane strain: the ends are held
  for (const Kind &kind : kinds)
    for (const double nu : {0.3, 0.4999})
      {
        if (nu > 0.4 && kind.element == ElementKind::standard)
          continue;
        Scene scene                      = tube(kind);
        scene.materials[0].poisson_ratio = nu;
        load(scene, 0, "left", "0", "0");
        scene.tractions[0].pressure = field("100");
        support(scene, 0, "bottom", "", "0");
        support(scene, 0, "top", "", "0");
        const double a = 1, b = 2, E = scene.materials[0].young_modulus, mu = E / (2 * (1 + nu));
        const double A   = 100 * a * a / (b * b - a * a) * (1 + nu) * (1 - 2 * nu) / E,
                     B   = 100 * a * a * b * b / (b * b - a * a) / (2 * mu);
        const auto error = [&](const unsigned int n) {
          const OnGrid section_of_tube(scene, section(kind, {{n, n / 2}}, a, b - a, 2, false));
          return section_of_tube.difference(section_of_tube.solve(),
                                            [&](const Point &x) { return Eigen::Vector2d(A * x[0] + B / x[0], 0); });
        };
        const double coarse = error(8), fine = error(16);
        EXPECT_LT(fine, kind.degree == 1 ? 2e-3 : 3e-5) << name(kind) << ", nu = " << nu;
        EXPECT_GT(std::log2(coarse / fine), kind.degree == 1 ? 1.7 : 2.6) << name(kind) << ", nu = " << nu;
      }
}

TEST(Revolution, loads_act_on_the_whole_circumference)
{
  const Kind kind{Cells::quadrilaterals, 1, ElementKind::standard};
  const auto resultant = [&](const Scene &scene) {
    return OnGrid(scene, section(kind, {{4, 3}}, 2, 1, 2)).resultant();
  };
  Scene pulled = tube(kind);
  load(pulled, 0, "top", "0", "7");
  EXPECT_NEAR(resultant(pulled)[1] / (7 * pi * 5), 1, 1e-13);
  pulled.tractions[0].components[1] = field("7*x"); // by the adaptive quadrature
  EXPECT_NEAR(resultant(pulled)[1] / (7 * 2 * pi * 19 / 3), 1, 1e-12);
  Scene heavy = tube(kind);
  heavy.body_forces.push_back({});
  heavy.body_forces[0].bodies          = {0};
  heavy.body_forces[0].acceleration[1] = field("-10");
  EXPECT_NEAR(resultant(heavy)[1] / (-10 * 2 * pi * 5), 1, 1e-13);
  heavy.body_forces[0].acceleration[1]  = field("0");
  heavy.body_forces[0].angular_velocity = field("3"); // density 2: 2 * 9 * integral of r 2 pi r, no axial part
  const auto spinning                   = resultant(heavy);
  EXPECT_NEAR(spinning[0] / (2 * 9 * 2 * pi * 19 / 3), 1, 1e-12);
  EXPECT_LT(std::abs(spinning[1]), 1e-12 * spinning[0]);
}

TEST(Revolution, uniform_heat_of_a_free_body_leaves_no_stress)
{
  for (const Kind &kind : kinds)
    for (const double a : {0., 2.})
      {
        Scene scene = tube(kind);
        support(scene, 0, "bottom", "", "0");
        scene.temperatures.push_back({"warm", {0}, field("50")});
        const OnGrid body(scene, section(kind, {{8, 4}}, a, 1, 4));
        const auto   u      = body.solve();
        const double strain = 1e-3 * 50;
        EXPECT_LT(
          body.difference(u, [&](const Point &x) -> Eigen::Vector2d { return strain * Eigen::Vector2d(x[0], x[1]); }),
          1e-10)
          << name(kind) << ", bore " << a;
        EXPECT_LT(body.stress_difference(body.stress(u),
                                         [](const Point &) -> Eigen::Vector4d { return Eigen::Vector4d::Zero(); }),
                  1e-9 * scene.materials[0].young_modulus * strain)
          << name(kind) << ", bore " << a;
      }
}

TEST(Revolution, tributary_areas_are_of_revolution_and_that_of_a_quadratic_node_on_the_axis_is_none)
{
  const mesh::Kinematics<2> plane, revolved(PlaneState::axisymmetric);
  for (const unsigned int n_nodes : {2, 3})
    {
      mechanics::SurfaceEdge<2> edge;
      edge.n_nodes    = n_nodes;
      edge.at         = {{{{0, 1}}, {{3, 5}}, {{1.5, 3}}}};
      const auto area = edge.tributary_measures(revolved), length = edge.tributary_measures(plane);
      EXPECT_NEAR(length[0] + length[1] + length[2], 5, 1e-14);
      EXPECT_NEAR((area[0] + area[1] + area[2]) / (pi * 3 * 5), 1, 1e-14); // a cone
      if (n_nodes == 2)
        EXPECT_NEAR(area[0] / (pi * 3 * 5), 1. / 3, 1e-14);
      else
        EXPECT_EQ(area[0], 0);
    }
}
