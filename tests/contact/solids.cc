// Solids on obstacles: friction within discs, against GetFEM, a prototype in numpy and the plane.
#include <slipstick/base/exceptions.h>
#include <slipstick/contact/checks.h>
#include <slipstick/contact/friction.h>
#include <slipstick/interface/contact_constraints.h>
#include <slipstick/mechanics/assembly.h>
#include <slipstick/mesh/decomposition.h>

#include <deal.II/base/mpi.h>
#include <deal.II/dofs/dof_tools.h>

#include <gtest/gtest.h>

#include <fstream>
#include <sstream>

using namespace slipstick;

namespace
{
  template <int dim>
  scene::Field<dim> field(const std::string &formula)
  {
    return scene::Field<dim>(formula, "test");
  }

  template <int dim>
  std::vector<std::string> names_of(const scene::Scene<dim> &scene)
  {
    std::vector<std::string> names;
    for (const auto &body : scene.bodies)
      names.push_back(body.name);
    return names;
  }

  /// A scene solved from mesh to contact nodes.
  template <int dim>
  struct Solved
  {
    explicit Solved(const scene::Scene<dim> &scene)
      : mesh(mesh::make_mesh(scene, MPI_COMM_WORLD))
      , spaces(mesh, 1)
      , dual(mechanics::assemble(scene, mesh, spaces, 1.),
             interface::contact_constraints(scene, mesh, spaces, 1.),
             contact::resolved_options(scene).dual,
             names_of(scene),
             MPI_COMM_WORLD)
      , solution(
          contact::solve(dual, contact::SlipLaw(scene, dual, 1.), contact::resolved_options(scene), scene.friction, {}))
      , checked(contact::check(dual,
                               solution.multipliers,
                               dual.recover(solution.multipliers, solution.free).u,
                               solution.slip_bound,
                               solution.free,
                               scene.bodies.size()))
    {
      for (const auto &of_rank : dealii::Utilities::MPI::all_gather(MPI_COMM_WORLD, checked.nodes))
        nodes.insert(nodes.end(), of_rank.begin(), of_rank.end());
      result = contact::pair_results(nodes, {"contact"}).front();
    }

    mesh::Mesh<dim>                   mesh;
    mechanics::Spaces<dim>            spaces;
    tfeti::DualProblem                dual;
    contact::DualSolution             solution;
    contact::CheckedContact           checked;
    std::vector<contact::ContactNode> nodes; // of all ranks
    contact::PairResult               result;
  };

  /// A cube (in the plane a square) of 10 mm, clamped on its left side, pressed by 500 MPa on its top.
  template <int dim>
  scene::Scene<dim> pressed_cube(const unsigned int blocks, const unsigned int cells_per_block)
  {
    scene::Scene<dim> scene;
    scene.plane_state = scene::PlaneState::plane_strain;
    scene.materials.resize(1);
    scene.materials[0].young_modulus = 1e5;
    scene.materials[0].poisson_ratio = 0.35;
    scene.bodies.resize(1);
    scene.bodies[0].name                = "body";
    scene.decomposition.blocks          = blocks;
    scene.decomposition.cells_per_block = cells_per_block;
    for (unsigned int d = 0; d < dim; ++d)
      scene.bodies[0].size[d] = 10;
    scene.supports.resize(1);
    scene.supports[0].name  = "held";
    scene.supports[0].where = {0, "left"};
    scene.supports[0].components.fill(field<dim>("0"));
    scene.tractions.resize(1);
    scene.tractions[0].name     = "pressed";
    scene.tractions[0].where    = {0, "top"};
    scene.tractions[0].pressure = field<dim>("500");
    return scene;
  }

  template <int dim>
  void touch(scene::Scene<dim>        &scene,
             const dealii::Point<dim> &center,
             const double              radius,
             const std::string        &law,
             const std::string        &number)
  {
    scene.obstacles.resize(1);
    scene.obstacles[0].name   = "round";
    scene.obstacles[0].center = center;
    scene.obstacles[0].radius = radius;
    scene.contacts.resize(1);
    scene.contacts[0].name  = "contact";
    scene.contacts[0].slave = {0, "bottom"};
    scene.contacts[0].law   = scene::make_law<dim>(law, {number});
  }

  scene::Scene<3> cube_on_sphere(const std::string &law, const std::string &number, const unsigned int cells)
  {
    scene::Scene<3> scene = pressed_cube<3>(2, cells / 2);
    touch<3>(scene, {5, -100, 5}, 100, law, number);
    scene.solver.tolerance = 1e-8;
    return scene;
  }

  void expect_same(const contact::PairResult &a, const contact::PairResult &b, const double tolerance)
  {
    EXPECT_NEAR(a.max_pressure / b.max_pressure, 1, tolerance);
    EXPECT_NEAR(a.normal_force / b.normal_force, 1, tolerance);
    EXPECT_EQ(a.contact_nodes, b.contact_nodes);
    EXPECT_EQ(a.stick_nodes, b.stick_nodes);
    EXPECT_EQ(a.slip_nodes, b.slip_nodes);
  }
} // namespace

// Figures of GetFEM 5.4 (nodal augmented Lagrangian) and of the prototype, equal to the digits given.
TEST(Solids, cube_on_sphere_agrees_with_getfem)
{
  struct Case
  {
    std::string  law, number;
    double       pressure, force;
    unsigned int n_contact;
  };
  for (const auto &expected :
       {Case{"Tresca", "100", 1666.441, 16889.394, 45}, Case{"Coulomb", "0.3", 1709.0033, 17913.706, 45}})
    {
      SCOPED_TRACE(expected.law);
      const Solved<3> solved(cube_on_sphere(expected.law, expected.number, 16));
      EXPECT_EQ(solved.solution.status, qp::Status::converged);
      EXPECT_LE(solved.solution.counts.hessian_multiplications, 90u);
      EXPECT_NEAR(solved.result.max_pressure / expected.pressure, 1, 1e-6);
      EXPECT_NEAR(solved.result.normal_force / expected.force, 1, 1e-6);
      EXPECT_EQ(solved.result.contact_nodes, expected.n_contact);
      EXPECT_EQ(solved.dual.kernel_dimension(), 48u);
      if (expected.law == "Coulomb")
        {
          EXPECT_EQ(solved.result.stick_nodes, 2u);
        }
      EXPECT_LT(solved.checked.checks.worst().second, 1e-5) << solved.checked.checks.worst().first;
      for (const auto &node : solved.nodes)
        if (node.status == contact::ContactStatus::slip && node.slip > 1e-9) // friction is against the slip
          {
            double product = 0;
            for (unsigned int d = 0; d < 3; ++d)
              product += node.traction[d] * node.slip_vector[d];
            EXPECT_NEAR(product / (node.slip * node.slip_bound), -1, 1e-4);
          }
    }
}

TEST(Solids, turning_the_scene_and_cutting_it_otherwise_change_nothing)
{
  for (const auto &[law, number] : {std::pair("Tresca", "100"), std::pair("Coulomb", "0.3")})
    {
      SCOPED_TRACE(law);
      scene::Scene<3> scene  = cube_on_sphere(law, number, 8);
      scene.solver.tolerance = 1e-11;
      const Solved<3> as_it_is(scene);
      ASSERT_EQ(as_it_is.solution.status, qp::Status::converged);

      scene::Scene<3> turned          = scene;
      auto           &placement       = turned.bodies[0].placement;
      placement.rotation              = 37;
      placement.axis                  = dealii::Point<3>(1, 2, 2);
      placement.translation           = dealii::Point<3>(1, -2, 3);
      const dealii::Tensor<1, 3> axis = placement.axis / 3., x = turned.obstacles[0].center;
      const double               angle = 37 * dealii::numbers::PI / 180;
      turned.obstacles[0].center =
        placement.translation +
        (std::cos(angle) * x + std::sin(angle) * cross_product_3d(axis, x) + (1 - std::cos(angle)) * (axis * x) * axis);
      expect_same(Solved<3>(turned).result, as_it_is.result, 1e-8);

      scene.bodies[0].cells          = std::array<unsigned int, 3>{{8, 8, 8}};
      scene.decomposition.method     = scene::DecompositionMethod::metis;
      scene.decomposition.subdomains = 5;
      expect_same(Solved<3>(scene).result, as_it_is.result, 1e-8);
      scene.decomposition.method = scene::DecompositionMethod::none;
      expect_same(Solved<3>(scene).result, as_it_is.result, 1e-8);
    }
}

// One layer of cells between planes of symmetry on a cylinder.
TEST(Solids, plane_strain_between_planes_of_symmetry)
{
  for (const auto &[law, number] : {std::pair("Tresca", "150"), std::pair("Coulomb", "0.3")})
    {
      SCOPED_TRACE(law);
      scene::Scene<2> plane = pressed_cube<2>(2, 8);
      touch<2>(plane, {5, -100}, 100, law, number);
      scene::Scene<3> space = pressed_cube<3>(1, 16);
      touch<3>(space, {5, -100, 0}, 100, law, number);
      space.obstacles[0].shape       = scene::ObstacleShape::cylinder;
      space.obstacles[0].normal      = dealii::Point<3>(0, 0, 1);
      space.bodies[0].size[2]        = 2;
      space.bodies[0].cells          = std::array<unsigned int, 3>{{16, 16, 1}};
      space.decomposition.method     = scene::DecompositionMethod::metis;
      space.decomposition.subdomains = 4;
      for (const std::string side : {"front", "back"})
        {
          space.supports.emplace_back();
          space.supports.back().name   = side;
          space.supports.back().where  = {0, side};
          space.supports.back().normal = field<3>("0");
        }
      plane.solver.tolerance = space.solver.tolerance = 1e-11;
      const Solved<2> in_the_plane(plane);
      const Solved<3> in_space(space);
      EXPECT_NEAR(in_space.result.max_pressure / in_the_plane.result.max_pressure, 1, 1e-8);
      EXPECT_NEAR(in_space.result.normal_force / (2 * in_the_plane.result.normal_force), 1, 1e-8); // 2 mm thick
      EXPECT_EQ(in_space.result.contact_nodes, 2 * in_the_plane.result.contact_nodes);
      EXPECT_EQ(in_space.result.slip_nodes, 2 * in_the_plane.result.slip_nodes);
      EXPECT_EQ(in_space.result.stick_nodes, 2 * in_the_plane.result.stick_nodes);
    }
}

namespace
{
  /// A block that rests on a half space in space by friction alone, weighed down along a direction that the mesh knows nothing of.
  scene::Scene<3> resting_block(const double angle, const double friction)
  {
    scene::Scene<3> scene = pressed_cube<3>(2, 2);
    scene.supports.clear();
    const std::array<double, 3> along{{std::sin(angle) * 0.6, -std::cos(angle), std::sin(angle) * 0.8}};
    scene.tractions.clear();
    scene.body_forces.resize(1);
    scene.body_forces[0].name   = "weight";
    scene.body_forces[0].bodies = {0};
    for (unsigned int d = 0; d < 3; ++d)
      scene.body_forces[0].force[d] = scene::Field<3>(std::to_string(along[d]), "test");
    touch<3>(scene, {0, 0, 0}, 1, "Coulomb", std::to_string(friction));
    scene.obstacles[0].shape  = scene::ObstacleShape::half_plane;
    scene.obstacles[0].normal = dealii::Point<3>(0, 1, 0);
    scene.solver.tolerance    = 1e-8;
    return scene;
  }
} // namespace

// Slides when the tangent of the angle is above the coefficient, whatever the direction.
TEST(Solids, block_rests_on_an_oblique_incline_up_to_the_angle_of_friction)
{
  const double    angle = 0.2;
  const Solved<3> rests(resting_block(angle, 1.2 * std::tan(angle)));
  EXPECT_EQ(rests.solution.status, qp::Status::converged);
  EXPECT_NEAR(rests.result.normal_force / (1000 * std::cos(angle)), 1, 1e-4);
  std::array<double, 3> friction{};
  for (const auto &node : rests.nodes)
    for (unsigned int d = 0; d < 3; ++d)
      friction[d] += node.traction[d] * node.area;
  EXPECT_NEAR(friction[0] / (-600 * std::sin(angle)), 1, 1e-4);
  EXPECT_NEAR(friction[2] / (-800 * std::sin(angle)), 1, 1e-4);
  EXPECT_LT(rests.checked.checks.worst().second, 1e-5) << rests.checked.checks.worst().first;
  EXPECT_THROW(Solved<3>(resting_block(angle, 0.98 * std::tan(angle))), NoEquilibrium);
}

namespace
{
  /// Two blocks of 10 x 5 x 10 mm, one on the other, with meshes that do not match, between planes of symmetry, pressed by 100 MPa.
  scene::Scene<3> two_blocks(const std::string &law, const std::string &number, const double poisson_ratio)
  {
    scene::Scene<3> scene            = pressed_cube<3>(1, 1);
    scene.decomposition.method       = scene::DecompositionMethod::metis;
    scene.decomposition.subdomains   = 5;
    scene.materials[0].poisson_ratio = poisson_ratio;
    scene.bodies.push_back(scene.bodies[0]);
    scene.bodies[0].size[1] = scene.bodies[1].size[1] = 5;
    scene.bodies[0].cells                             = std::array<unsigned int, 3>{{3, 2, 4}};
    scene.bodies[1].cells                             = std::array<unsigned int, 3>{{4, 3, 5}};
    scene.bodies[1].name                              = "other";
    scene.bodies[1].placement.translation             = dealii::Point<3>(0, 5, 0);
    scene.supports.clear();
    for (const auto &[body, side] : std::vector<std::pair<unsigned int, std::string>>{{0, "bottom"},
                                                                                      {0, "left"},
                                                                                      {0, "back"},
                                                                                      {1, "left"},
                                                                                      {1, "back"}})
      {
        scene.supports.emplace_back();
        scene.supports.back().name   = side + std::to_string(body);
        scene.supports.back().where  = {body, side};
        scene.supports.back().normal = field<3>("0");
      }
    scene.tractions[0].where    = {1, "top"};
    scene.tractions[0].pressure = field<3>("100");
    scene.contacts.resize(1);
    scene.contacts[0].name   = "contact";
    scene.contacts[0].slave  = {1, "bottom"};
    scene.contacts[0].master = scene::BoundaryName{0, "top"};
    scene.contacts[0].law    = scene::make_law<3>(law, {number});
    scene.solver.tolerance   = 1e-11;
    return scene;
  }

  /// Writes a block of n cells a direction from (0, 0, 0) to @p size in Gmsh's format: hexahedra, or six tetrahedra for each.
  void write_block(const std::string                 &file,
                   const dealii::Point<3>            &size,
                   const std::array<unsigned int, 3> &n,
                   const bool                         in_tetrahedra)
  {
    const auto node = [&](const unsigned int i, const unsigned int j, const unsigned int k) {
      return 1 + i + (n[0] + 1) * (j + (n[1] + 1) * k);
    };
    std::ostringstream nodes, elements;
    unsigned int       n_elements = 0;
    nodes.precision(17);
    for (unsigned int k = 0; k <= n[2]; ++k)
      for (unsigned int j = 0; j <= n[1]; ++j)
        for (unsigned int i = 0; i <= n[0]; ++i)
          nodes << node(i, j, k) << ' ' << size[0] * i / n[0] << ' ' << size[1] * j / n[1] << ' ' << size[2] * k / n[2]
                << '\n';
    const auto add = [&](const int type, const int physical, const std::vector<unsigned int> &of) {
      elements << ++n_elements << ' ' << type << " 2 " << physical << ' ' << physical;
      for (const unsigned int v : of)
        elements << ' ' << v;
      elements << '\n';
    };
    const std::array<std::string, 6> names = {{"left", "right", "bottom", "top", "back", "front"}};
    for (unsigned int k = 0; k < n[2]; ++k)
      for (unsigned int j = 0; j < n[1]; ++j)
        for (unsigned int i = 0; i < n[0]; ++i)
          {
            const std::array<unsigned int, 3> at{{i, j, k}};
            const auto                        v = [&](const unsigned int corner) {
              return node(i + (corner & 1), j + (corner >> 1 & 1), k + (corner >> 2));
            };
            if (in_tetrahedra) // along the six ways from corner 0 to corner 7
              for (const auto &[a, b] :
                   std::vector<std::pair<int, int>>{{1, 3}, {3, 2}, {2, 6}, {6, 4}, {4, 5}, {5, 1}})
                add(4, 7, {v(0), v(a), v(b), v(7)});
            else
              add(5, 7, {v(0), v(1), v(3), v(2), v(4), v(5), v(7), v(6)});
            for (unsigned int f = 0; f < 6; ++f)
              if (at[f / 2] == (f % 2 == 0 ? 0 : n[f / 2] - 1))
                {
                  std::vector<unsigned int> of;
                  for (unsigned int c = 0; c < 8; ++c)
                    if ((c >> (f / 2) & 1) == f % 2)
                      of.push_back(v(c));
                  if (in_tetrahedra) // all diagonals run from the least corner to the largest
                    for (const unsigned int other : {1, 2})
                      add(2, f + 1, {of[0], of[other], of[3]});
                  else
                    add(3, f + 1, {of[0], of[1], of[3], of[2]});
                }
          }
    std::ofstream out(file);
    out << "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$PhysicalNames\n7\n";
    for (unsigned int f = 0; f < 6; ++f)
      out << "2 " << f + 1 << " \"" << names[f] << "\"\n";
    out << "3 7 \"block\"\n$EndPhysicalNames\n$Nodes\n"
        << node(n[0], n[1], n[2]) << '\n'
        << nodes.str() << "$EndNodes\n$Elements\n"
        << n_elements << '\n'
        << elements.str() << "$EndElements\n";
  }

  dealii::Tensor<1, 3> turned(const dealii::Tensor<1, 3> &x, const double angle, const dealii::Tensor<1, 3> &axis)
  {
    return std::cos(angle) * x + std::sin(angle) * cross_product_3d(axis, x) +
           (1 - std::cos(angle)) * (axis * x) * axis;
  }

  /// Everything as the turned scene.
  void turn(scene::Scene<3> &scene, const double degrees, const dealii::Point<3> &axis)
  {
    for (auto &body : scene.bodies)
      {
        const auto along           = dealii::Tensor<1, 3>(axis) / axis.norm();
        body.placement.rotation    = degrees;
        body.placement.axis        = axis;
        body.placement.translation = dealii::Point<3>(
          turned(dealii::Tensor<1, 3>(body.placement.translation), degrees * dealii::numbers::PI / 180, along));
      }
  }
} // namespace

// Uniform stress between meshes that do not match, flat and turned.
TEST(Solids, patch_test_between_meshes_that_do_not_match)
{
  for (const double poisson_ratio : {0., 0.3})
    for (const double degrees : {0., 37.})
      for (const auto &[law, number] :
           {std::pair("frictionless", "0"), std::pair("Coulomb", "0.3"), std::pair("bonded", "0")})
        for (const std::string how : {"", "exchanged", "tetrahedra", "hexahedra"})
          {
            const bool is_exchanged = how == "exchanged";
            if (how == "tetrahedra" && std::string(law) == "Coulomb")
              continue; // the Newton method ends a digit above 1e-11: doc/status.md
            SCOPED_TRACE(std::string(law) + " " + how + std::to_string(degrees) + " " + std::to_string(poisson_ratio));
            auto scene = two_blocks(law, number, poisson_ratio);
            if (how == "tetrahedra" || how == "hexahedra")
              {
                auto &body = scene.bodies[0];
                body.shape = scene::Shape::mesh;
                body.file =
                  "solids_" + std::to_string(dealii::Utilities::MPI::n_mpi_processes(MPI_COMM_WORLD)) + ".msh";
                if (dealii::Utilities::MPI::this_mpi_process(MPI_COMM_WORLD) == 0)
                  write_block(body.file, {10, 5, 10}, {{3, 2, 4}}, how == "tetrahedra");
                MPI_Barrier(MPI_COMM_WORLD);
              }
            if (is_exchanged)
              std::swap(scene.contacts[0].slave, *scene.contacts[0].master);
            turn(scene, degrees, dealii::Point<3>(1, 2, 2));
            const Solved<3> solved(scene);
            EXPECT_EQ(solved.solution.status, qp::Status::converged);
            EXPECT_NEAR(solved.result.normal_force / 1e4, 1, 1e-10);
            EXPECT_EQ(solved.nodes.size(), is_exchanged ? 20u : 30u);
            for (const auto &node : solved.nodes)
              EXPECT_NEAR(node.pressure, 100, 1e-8);
            EXPECT_LT(solved.checked.checks.worst().second, 1e-9) << solved.checked.checks.worst().first;
            // u = (nu, -1, nu) p / E times the coordinates
            const double               E = 1e5, angle = degrees * dealii::numbers::PI / 180;
            const dealii::Tensor<1, 3> axis({1. / 3, 2. / 3, 2. / 3});
            const auto                 u = solved.dual.recover(solved.solution.multipliers, solved.solution.free).u;
            for (unsigned int p = 0; p < u.size(); ++p)
              {
                std::map<dealii::types::global_dof_index, dealii::Point<3>> places;
                dealii::DoFTools::map_dofs_to_support_points(*solved.spaces.of(p).mapping,
                                                             *solved.spaces.dof_handlers[p],
                                                             places);
                for (unsigned int i = 0; i < u[p].size(); i += 3)
                  {
                    const auto x = turned(dealii::Tensor<1, 3>(places[i]), -angle, axis);
                    const auto v = turned(dealii::Tensor<1, 3>({u[p][i], u[p][i + 1], u[p][i + 2]}), -angle, axis);
                    EXPECT_NEAR(v[0], poisson_ratio * 100 / E * x[0], 1e-12);
                    EXPECT_NEAR(v[1], -100 / E * x[1], 1e-12);
                    EXPECT_NEAR(v[2], poisson_ratio * 100 / E * x[2], 1e-12);
                  }
              }
          }
}
