#include "grid.h"
#include "mesh/piece.h"

using namespace slipstick;
using namespace slipstick::test;
using scene::PlaneState;

namespace
{
  Eigen::Matrix2d stress(const Scene &scene, const Eigen::Matrix2d &gradient)
  {
    const double          E = scene.materials[0].young_modulus, nu = scene.materials[0].poisson_ratio;
    const Eigen::Matrix2d strain = (gradient + gradient.transpose()) / 2;
    // Hooke's law solved for the stress, from the in-plane compliance
    const bool      is_strain = scene.plane_state == PlaneState::plane_strain;
    const double    a = is_strain ? (1 - nu * nu) / E : 1 / E, b = is_strain ? -nu * (1 + nu) / E : -nu / E;
    Eigen::Matrix2d compliance;
    compliance << a, b, b, a;
    const Eigen::Vector2d normal = compliance.inverse() * strain.diagonal();
    const double          shear  = E / (1 + nu) * strain(0, 1);
    Eigen::Matrix2d       sigma;
    sigma << normal[0], shear, shear, normal[1];
    return sigma;
  }

  /// Applies the tractions of a uniform stress on all four edges of the box.
  void load_uniformly(Scene &scene, const Eigen::Matrix2d &sigma)
  {
    const auto pull = [&](const std::string &boundary, const Eigen::Vector2d &normal) {
      const Eigen::Vector2d t = sigma * normal;
      load(scene, 0, boundary, digits(t[0]), digits(t[1]));
    };
    pull("left", {-1, 0});
    pull("right", {1, 0});
    pull("bottom", {0, -1});
    pull("top", {0, 1});
  }

  Eigen::VectorXd linear_field(const mechanics::Spaces<2> &spaces, const Eigen::Matrix2d &gradient)
  {
    const auto      x = node_positions(spaces, 0);
    Eigen::VectorXd u(2 * x.size());
    for (unsigned int i = 0; i < x.size(); ++i)
      u.segment<2>(2 * i) = gradient * Eigen::Vector2d(x[i][0], x[i][1]) + Eigen::Vector2d(0.3, -0.1);
    return u;
  }

  Eigen::VectorXd times(const tfeti::SubdomainMatrices &matrices, const Eigen::VectorXd &u)
  {
    return matrices.stiffness.selfadjointView<Eigen::Lower>() * u;
  }

  /// A box with displaced inner vertices.
  mesh::MeshPiece<2> distorted_piece(const Scene &scene, const unsigned int n)
  {
    auto       piece = mesh::rectangle_piece<2>(scene.bodies[0], {{n, n}}, {{1, 1}}, {{0, 0}});
    const auto moves = random_vector(2 * piece.vertices.size(), 4);
    for (unsigned int v = 0; v < piece.vertices.size(); ++v)
      {
        Point &x = piece.vertices[v];
        if (x[0] > 0 && x[0] < 10 && x[1] > 0 && x[1] < 10)
          x += Point(moves[2 * v], moves[2 * v + 1]) * (2.5 / n);
      }
    return piece;
  }

  const std::vector<Cut> cuts = {whole(), blocks(3), metis(7)};
} // namespace

TEST(Stiffness, uniform_strain_passes_the_patch_test_on_a_distorted_mesh)
{
  for (const unsigned int degree : {1, 2})
    for (const auto state : {PlaneState::plane_stress, PlaneState::plane_strain})
      for (const unsigned int n : {2, 4})
        {
          Scene scene               = box(n, degree);
          scene.plane_state         = state;
          scene.bodies[0].thickness = 3;
          Eigen::Matrix2d gradient;
          gradient << 1e-3, 2e-4, -7e-4, 5e-4;
          load_uniformly(scene, stress(scene, gradient));
          const mesh::Mesh<2>        mesh = mesh_of(distorted_piece(scene, n));
          const mechanics::Spaces<2> spaces(mesh, degree);
          const auto                 system = mechanics::assemble(scene, mesh, spaces, 1.)[0];
          EXPECT_LT(relative_difference(times(system, linear_field(spaces, gradient)), system.load), 1e-12)
            << "degree " << degree << ", state " << int(state);
        }
}

TEST(Stiffness, energy_of_uniform_tension)
{
  for (const unsigned int degree : {1, 2})
    for (const auto state : {PlaneState::plane_stress, PlaneState::plane_strain})
      {
        Scene scene               = box(3, degree);
        scene.plane_state         = state;
        scene.bodies[0].thickness = 3;
        const double    E = scene.materials[0].young_modulus, nu = scene.materials[0].poisson_ratio, sigma = 250;
        const double    E_plane  = state == PlaneState::plane_stress ? E : E / (1 - nu * nu);
        const double    nu_plane = state == PlaneState::plane_stress ? nu : nu / (1 - nu);
        Eigen::Matrix2d gradient;
        gradient << sigma / E_plane, 0, 0, -nu_plane * sigma / E_plane;
        const Torn            torn(scene, MPI_COMM_SELF);
        const Eigen::VectorXd u = linear_field(torn.spaces, gradient);
        EXPECT_NEAR(u.dot(times(torn.matrices[0], u)) / 2 / (sigma * sigma / (2 * E_plane) * 10 * 10 * 3), 1, 1e-12);
      }
}

TEST(Stiffness, is_stored_as_a_sorted_lower_triangle)
{
  const Torn torn(cut(box(6, 2), metis(4)));
  for (const auto &system : torn.matrices)
    {
      EXPECT_TRUE(system.stiffness.isCompressed());
      for (int column = 0; column < system.stiffness.outerSize(); ++column)
        {
          int above = column - 1;
          for (Eigen::SparseMatrix<double>::InnerIterator entry(system.stiffness, column); entry; ++entry)
            {
              EXPECT_GT(entry.row(), above);
              above = entry.row();
            }
        }
    }
}

TEST(Stiffness, kernel_is_spanned_by_the_rigid_motions)
{
  for (const unsigned int degree : {1, 2})
    for (const Cut &how : cuts)
      for (const auto &system : Torn(cut(box(6, degree), how)).matrices)
        {
          const Eigen::MatrixXd K = full(system.stiffness);
          EXPECT_LT((K * system.kernel).norm(), 1e-13 * K.norm() * system.kernel.norm());
          const Eigen::VectorXd eigenvalues = tfeti::symmetric_eigenvalues(K);
          EXPECT_LT(eigenvalues.head(3).cwiseAbs().maxCoeff(), 1e-13 * eigenvalues.tail(1)[0]);
          EXPECT_GT(eigenvalues[3], 1e-5 * eigenvalues.tail(1)[0]);
        }
}

TEST(Stiffness, kernel_turns_into_the_motions_of_the_body)
{
  for (const Cut &how : cuts)
    {
      Scene scene = box(6);
      add_body(scene, "beam", {20, 3}, {12, 4}, {{6, 6}});
      const Torn torn(cut(scene, how));
      for (unsigned int p = 0; p < torn.matrices.size(); ++p)
        {
          const auto     &system = torn.matrices[p];
          const auto     &body   = scene.bodies[system.body];
          const Point     center = body.origin + (body.size - Point()) / 2;
          const double    length = body.size.norm() / 2;
          const auto      x      = node_positions(torn.spaces, p);
          Eigen::MatrixXd expect(2 * x.size(), 3);
          for (unsigned int i = 0; i < x.size(); ++i)
            expect.middleRows<2>(2 * i) << 1, 0, -(x[i][1] - center[1]) / length, 0, 1, (x[i][0] - center[0]) / length;
          EXPECT_LT(relative_difference(system.kernel * system.body_modes, expect), 1e-13);
        }
    }
}

TEST(Stiffness, is_proportional_to_the_thickness_and_to_the_modulus)
{
  Scene                 scene = box(3);
  const Eigen::MatrixXd one   = full(Torn(scene, MPI_COMM_SELF).matrices[0].stiffness);
  scene.bodies[0].thickness   = 7;
  scene.materials[0].young_modulus *= 3;
  EXPECT_LT(relative_difference(full(Torn(scene, MPI_COMM_SELF).matrices[0].stiffness), 21 * one), 1e-14);
}

TEST(Stiffness, every_body_has_its_own_material)
{
  for (const Cut &how : cuts)
    {
      Scene scene = box(6);
      add_body(scene, "other", {20, 0}, {10, 10}, {{6, 6}});
      scene.materials[1].young_modulus *= 1000;
      double trace[2] = {0, 0};
      for (const auto &system : Torn(cut(scene, how)).matrices)
        trace[system.body] += system.stiffness.diagonal().sum();
      dealii::Utilities::MPI::sum(trace, MPI_COMM_WORLD, trace);
      EXPECT_NEAR(trace[1] / trace[0], 1000, 1e-9);
    }
}

TEST(Stiffness, boundary_unknowns_are_those_of_the_outer_nodes)
{
  for (const unsigned int degree : {1, 2})
    {
      const Torn                torn(box(4, degree), MPI_COMM_SELF);
      const auto                x = node_positions(torn.spaces, 0);
      std::vector<unsigned int> expect;
      for (unsigned int i = 0; i < x.size(); ++i)
        for (const std::string boundary : {"left", "right", "bottom", "top"})
          if (lies_on(torn.scene.bodies[0], boundary, x[i]))
            {
              expect.push_back(2 * i);
              expect.push_back(2 * i + 1);
              break;
            }
      EXPECT_EQ(torn.matrices[0].boundary_dofs, expect);
    }
}

TEST(Lame, plane_stress_and_strain_coincide_without_lateral_contraction)
{
  scene::Material material;
  material.poisson_ratio = 0;
  const auto a           = mechanics::lame_coefficients(material, PlaneState::plane_stress),
             b           = mechanics::lame_coefficients(material, PlaneState::plane_strain);
  EXPECT_EQ(a.lambda, 0);
  EXPECT_EQ(b.lambda, 0);
  EXPECT_EQ(a.mu, b.mu);
  EXPECT_EQ(a.mu, material.young_modulus / 2);
}
