// Scenes of solids, solved from mesh to contact nodes.
#pragma once

#include <slipstick/base/exceptions.h>
#include <slipstick/contact/checks.h>
#include <slipstick/contact/friction.h>
#include <slipstick/interface/contact_constraints.h>
#include <slipstick/mechanics/assembly.h>
#include <slipstick/mesh/decomposition.h>
#include <slipstick/tfeti/recovery.h>

#include <deal.II/base/mpi.h>
#include <deal.II/dofs/dof_tools.h>

#include <gtest/gtest.h>

#include <fstream>
#include <sstream>

namespace slipstick::test
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
      , spaces(mesh, scene.discretization.degree)
      , dual(mechanics::assemble(scene, mesh, spaces, 1.),
             interface::contact_constraints(scene, mesh, spaces, 1.),
             contact::resolved_options(scene).dual,
             names_of(scene),
             MPI_COMM_WORLD)
      , solution(
          contact::solve(dual, contact::SlipLaw(scene, dual, 1.), contact::resolved_options(scene), scene.friction, {}))
      , checked(contact::check(dual,
                               contact::SlipLaw(scene, dual, 1.),
                               solution.multipliers,
                               tfeti::recover(dual, solution.multipliers, solution.free).u,
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

  /// Two blocks of 10 x 5 x 10 mm, one on the other, with meshes that do not match, between planes of symmetry, pressed
  /// by 100 MPa.
  inline scene::Scene<3> two_blocks(const std::string &law, const std::string &number, const double poisson_ratio)
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

  /// Writes a block of n cells per direction from (0, 0, 0) to @p size in Gmsh's format: hexahedra, or six tetrahedra
  /// for each.
  inline void write_block(const std::string                 &file,
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
            if (in_tetrahedra) // along the six paths from corner 0 to corner 7
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
                  if (in_tetrahedra) // all diagonals run from the smallest corner to the largest
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

  inline dealii::Tensor<1, 3> turned(const dealii::Tensor<1, 3> &x,
                                     const double                angle,
                                     const dealii::Tensor<1, 3> &axis)
  {
    return std::cos(angle) * x + std::sin(angle) * cross_product_3d(axis, x) +
           (1 - std::cos(angle)) * (axis * x) * axis;
  }

  /// Turns all bodies of the scene.
  inline void turn(scene::Scene<3> &scene, const double degrees, const dealii::Point<3> &axis)
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

  /// The block of two_blocks() from a file, of @p n cells, in place of the built-in one.
  inline void from_file(scene::Body<3> &body, const std::array<unsigned int, 3> &n, const bool in_tetrahedra)
  {
    body.shape = scene::Shape::mesh;
    body.file  = "solids_" + std::to_string(dealii::Utilities::MPI::n_mpi_processes(MPI_COMM_WORLD)) + ".msh";
    if (dealii::Utilities::MPI::this_mpi_process(MPI_COMM_WORLD) == 0)
      write_block(body.file, {10, 5, 10}, n, in_tetrahedra);
    MPI_Barrier(MPI_COMM_WORLD);
  }

  /// Expects the pressures, forces and displacements of uniaxial stress for two_blocks(), turned by @p degrees about
  /// (1, 2, 2).
  inline void expect_uniform_stress(const scene::Scene<3> &scene, const double degrees, const unsigned int n_nodes)
  {
    const Solved<3> solved(scene);
    EXPECT_EQ(solved.solution.status, qp::Status::converged);
    EXPECT_NEAR(solved.result.normal_force / 1e4, 1, 1e-10);
    EXPECT_EQ(solved.nodes.size(), n_nodes);
    for (const auto &node : solved.nodes)
      EXPECT_NEAR(node.pressure, 100, 1e-8);
    EXPECT_LT(solved.checked.checks.worst().second, 1e-9) << solved.checked.checks.worst().first;
    // u = (nu, -1, nu) p / E times the coordinates
    const double E = 1e5, nu = scene.materials[0].poisson_ratio, angle = degrees * dealii::numbers::PI / 180;
    const dealii::Tensor<1, 3> axis({1. / 3, 2. / 3, 2. / 3});
    const auto                 u = tfeti::recover(solved.dual, solved.solution.multipliers, solved.solution.free).u;
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
            EXPECT_NEAR(v[0], nu * 100 / E * x[0], 1e-12);
            EXPECT_NEAR(v[1], -100 / E * x[1], 1e-12);
            EXPECT_NEAR(v[2], nu * 100 / E * x[2], 1e-12);
          }
      }
  }
} // namespace slipstick::test
