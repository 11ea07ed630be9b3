#include "torn.h"

#include <slipstick/base/exceptions.h>
#include <slipstick/mesh/triangulate.h>

using namespace slipstick;
using namespace slipstick::test;
using tfeti::SubdomainMatrices;
using tfeti::SubdomainSystem;

namespace
{
  struct Example
  {
    std::string               name;
    SubdomainMatrices         matrices;
    std::vector<unsigned int> touched;
  };

  std::vector<unsigned int> unknowns_where(const Torn &torn, const std::function<bool(const Point &)> &condition)
  {
    std::vector<unsigned int> found;
    const auto                x = node_positions(torn.spaces, 0);
    for (unsigned int i = 0; i < x.size(); ++i)
      if (condition(x[i]))
        for (const unsigned int c : {0, 1})
          found.push_back(2 * i + c);
    return found;
  }

  /// Shapes and touched unknowns of all kinds.
  std::vector<Example> examples()
  {
    std::vector<Example> list;
    const auto           add =
      [&](const std::string &name, const Scene &scene, const std::function<bool(const Point &)> &condition) {
        const Torn torn(scene, MPI_COMM_SELF);
        list.push_back({name, torn.matrices[0], unknowns_where(torn, condition)});
      };
    Scene beam = cut({}, whole());
    add_body(beam, "beam", {3, -7}, {100, 1}, {{40, 1}});
    add("square", box(5), [](const Point &x) { return x[0] * x[1] * (10 - x[0]) * (10 - x[1]) == 0; });
    add("square of degree 2", box(3, 2), [](const Point &x) { return x[0] * x[1] * (10 - x[0]) * (10 - x[1]) == 0; });
    add("square touched nowhere", box(4), [](const Point &) { return false; });
    add("square touched in a node", box(4), [](const Point &x) { return x.norm() == 0; });
    add("square touched in two close nodes", box(20), [](const Point &x) { return x.norm() < 0.6 && x[1] == 0; });
    add("square touched inside", box(4), [](const Point &x) { return x.distance({5, 5}) < 3; });
    add("square touched along an edge", box(6), [](const Point &x) { return x[0] == 0; });
    add("beam", beam, [](const Point &) { return true; });
    add("beam touched at its end", beam, [](const Point &x) { return x[0] == 3; });
    const Torn parts(cut(box(12), metis(7)), MPI_COMM_SELF);
    for (unsigned int p = 0; p < parts.matrices.size(); ++p)
      list.push_back({"METIS part " + std::to_string(p), parts.matrices[p], parts.matrices[p].boundary_dofs});
    return list;
  }

  SubdomainSystem system(const Example &example, const bool with_trailing_block = true)
  {
    return {std::make_shared<tfeti::CholmodSession>(), example.matrices, example.touched, with_trailing_block};
  }

  Eigen::MatrixXd pseudo_inverse(const SubdomainSystem &system)
  {
    Eigen::MatrixXd inverse(system.n_unknowns(), system.n_unknowns());
    for (unsigned int i = 0; i < system.n_unknowns(); ++i)
      {
        Eigen::VectorXd column = Eigen::VectorXd::Unit(system.n_unknowns(), i);
        system.apply_pseudo_inverse(column);
        inverse.col(i) = column;
      }
    return inverse;
  }


  mesh::Mesh<2> mesh_of(const mesh::MeshPiece<2> &piece)
  {
    mesh::Mesh<2> mesh;
    mesh.comm            = MPI_COMM_SELF;
    mesh.first_subdomain = {0, 1};
    mesh.boundary_ids.resize(1);
    mesh.subdomains.push_back(mesh::triangulate(piece));
    return mesh;
  }

  /// Two squares of n x n cells that share a corner.
  mesh::MeshPiece<2> hinged_squares(const unsigned int n, const double skew)
  {
    mesh::MeshPiece<2>                          piece;
    std::map<std::pair<int, int>, unsigned int> number;
    const auto                                  vertex = [&](const int i, const int j) {
      const auto [entry, is_new] = number.emplace(std::make_pair(i, j), piece.vertices.size());
      if (is_new)
        {
          piece.vertices.emplace_back(0.1 + i + skew * j, 0.7 + j - 0.37 * skew / n * i * j); // no cell turned over
          piece.global_vertices.push_back(entry->second);
        }
      return entry->second;
    };
    for (const int at : {0, int(n)})
      for (int j = at; j < at + int(n); ++j)
        for (int i = at; i < at + int(n); ++i)
          piece.cells.push_back({{vertex(i, j), vertex(i + 1, j), vertex(i, j + 1), vertex(i + 1, j + 1)}});
    piece.subdomain = 41;
    return piece;
  }

  void expect_named(const SubdomainMatrices &matrices)
  {
    for (const bool with_trailing_block : {true, false})
      try
        {
          SubdomainSystem(std::make_shared<tfeti::CholmodSession>(),
                          matrices,
                          matrices.boundary_dofs,
                          with_trailing_block);
          ADD_FAILURE() << "not thrown";
        }
      catch (const InputError &error)
        {
          EXPECT_NE(std::string(error.what()).find("subdomain 41"), std::string::npos) << error.what();
        }
  }

  SubdomainMatrices square(const unsigned int n)
  {
    SubdomainMatrices matrices = Torn(box(n), MPI_COMM_SELF).matrices[0];
    matrices.subdomain         = 41;
    return matrices;
  }
} // namespace

TEST(SubdomainSystem, pseudo_inverse_is_a_generalised_inverse)
{
  for (const Example &example : examples())
    {
      const Eigen::MatrixXd K = full(example.matrices.stiffness), inverse = pseudo_inverse(system(example));
      EXPECT_LT(relative_difference(K * inverse * K, K), 1e-10) << example.name;
    }
}

TEST(SubdomainSystem, pseudo_inverse_without_trailing_block_is_the_same)
{
  for (const Example &example : examples())
    EXPECT_LT(relative_difference(pseudo_inverse(system(example, false)), pseudo_inverse(system(example, true))), 1e-9)
      << example.name;
}

TEST(SubdomainSystem, pseudo_inverse_after_release_is_the_same)
{
  for (const Example &example : examples())
    for (const bool with_trailing_block : {false, true})
      {
        auto            tested = system(example, with_trailing_block);
        const auto      load   = random_vector(tested.n_unknowns(), 1);
        Eigen::VectorXd before = load, after = load;
        tested.apply_pseudo_inverse(before);
        EXPECT_GT(tested.factor_bytes(), 0u) << example.name;
        tested.release();
        tested.apply_pseudo_inverse(after);
        EXPECT_LT(relative_difference(after, before), 1e-9) << example.name;
        EXPECT_EQ(tested.factor_bytes(), 0u) << example.name;
      }
}

TEST(SubdomainSystem, touched_stiffness_is_the_block_of_the_stiffness)
{
  for (const Example &example : examples())
    {
      const auto            tested  = system(example);
      const Eigen::MatrixXd K       = full(example.matrices.stiffness);
      const auto           &touched = example.touched;
      const auto            x       = random_vector(touched.size(), 1);
      EXPECT_LE((tested.apply_touched_stiffness(x) - K(touched, touched) * x).norm(), 1e-15 * K.norm() * x.norm())
        << example.name;
    }
}

TEST(SubdomainSystem, kernel_is_that_of_the_stiffness)
{
  for (const Example &example : examples())
    {
      const auto             tested = system(example);
      const Eigen::MatrixXd &R      = tested.kernel();
      Eigen::MatrixXd        KR(R.rows(), R.cols());
      for (int k = 0; k < R.cols(); ++k)
        KR.col(k) = tested.apply_stiffness(R.col(k));
      EXPECT_LT(KR.norm(), 1e-13 * full(example.matrices.stiffness).norm() * R.norm()) << example.name;
      EXPECT_GT(smallest_singular_value(R.transpose()), 0.1) << example.name;
    }
}

TEST(SubdomainSystem, pseudo_inverse_is_symmetric_and_positive_definite)
{
  for (const Example &example : examples())
    {
      const Eigen::MatrixXd inverse = pseudo_inverse(system(example));
      EXPECT_LT(relative_difference(inverse, inverse.transpose()), 1e-11) << example.name;
      EXPECT_GT(tfeti::symmetric_eigenvalues(inverse)[0], 0) << example.name;
    }
}

TEST(SubdomainSystem, block_is_that_of_the_pseudo_inverse_at_the_touched_unknowns)
{
  for (const Example &example : examples())
    {
      const auto            tested  = system(example);
      const Eigen::MatrixXd inverse = pseudo_inverse(tested),
                            block   = tested.pseudo_inverse_block(tfeti::Precision::double_precision).full();
      const auto &touched           = example.touched;
      ASSERT_EQ(block.rows(), int(touched.size()));
      double difference = 0;
      for (unsigned int i = 0; i < touched.size(); ++i)
        for (unsigned int j = 0; j < touched.size(); ++j)
          difference = std::max(difference, std::abs(block(i, j) - inverse(touched[i], touched[j])));
      EXPECT_LT(difference, 1e-11 * inverse.cwiseAbs().maxCoeff()) << example.name;
    }
}

TEST(SubdomainSystem, schur_complements_by_factors_are_those_by_blocks)
{
  for (const Example &example : examples())
    {
      if (example.touched.size() == std::size_t(example.matrices.load.size()) ||
          tfeti::fixing_unknowns(example.matrices.kernel, example.touched).second <
            0.1) // blocks hold other unknowns, too
        continue;
      SubdomainSystem by_factors = system(example, false);
      by_factors.prepare_schur_complement(std::make_shared<tfeti::CholmodSession>());
      const auto      x = random_vector(example.touched.size(), 1), y = random_vector(example.touched.size(), 2);
      Eigen::VectorXd expected;
      std::vector<Eigen::VectorXd> products{x, y};
      SubdomainSystem::apply_schur_complements({&by_factors, &by_factors}, products);
      system(example).schur_complement(tfeti::Precision::double_precision).multiply(x, expected);
      EXPECT_LT((products[0] - expected).norm(), 1e-11 * example.matrices.stiffness.norm() * x.norm()) << example.name;
      EXPECT_NEAR(x.dot(products[1]),
                  y.dot(products[0]),
                  1e-11 * example.matrices.stiffness.norm() * x.norm() * y.norm())
        << example.name;
    }
}

TEST(SubdomainSystem, congruent_subdomains_share_their_factors)
{
  const Torn                                    torn(cut(box(12), blocks(3)), MPI_COMM_SELF);
  const auto                                    session = std::make_shared<tfeti::CholmodSession>();
  std::vector<std::unique_ptr<SubdomainSystem>> systems;
  for (const SubdomainMatrices &matrices : torn.matrices)
    {
      systems.push_back(std::make_unique<SubdomainSystem>(session, matrices, matrices.boundary_dofs, false, true));
      systems.back()->prepare_schur_complement(session);
      EXPECT_EQ(systems.back()->factor(), systems.front()->factor());
      EXPECT_EQ(systems.back()->inner_factor(), systems.front()->inner_factor());
    }
  const auto           &K = torn.matrices.back().stiffness; // K K+ K = K
  const Eigen::VectorXd x = random_vector(K.rows(), 1), Kx = K.selfadjointView<Eigen::Lower>() * x;
  Eigen::VectorXd       u = Kx;
  systems.back()->apply_pseudo_inverse(u);
  EXPECT_LT(relative_difference(Eigen::VectorXd(K.selfadjointView<Eigen::Lower>() * u), Kx), 1e-12);
}

TEST(SubdomainSystem, fixing_unknowns_hold_all_motions)
{
  for (const Example &example : examples())
    {
      const Eigen::MatrixXd &R      = example.matrices.kernel;
      const auto             chosen = tfeti::fixing_unknowns(R, example.matrices.boundary_dofs).first;
      ASSERT_EQ(chosen.size(), 3u) << example.name;
      Eigen::Matrix3d at_chosen;
      for (unsigned int k = 0; k < 3; ++k)
        at_chosen.row(k) = R.row(chosen[k]);
      EXPECT_GT(smallest_singular_value(at_chosen), 0.2) << example.name;
    }
}

TEST(SubdomainSystem, fixing_unknowns_of_too_few_candidates_say_so)
{
  const auto matrices = square(4);
  EXPECT_LT(tfeti::fixing_unknowns(matrices.kernel, {0, 1}).second, 1e-12);
  EXPECT_LT(tfeti::fixing_unknowns(matrices.kernel, {}).second, 1e-12);
}

TEST(SubdomainSystem, kernel_that_is_no_rigid_motion_is_named)
{
  auto matrices = square(4);
  matrices.kernel(5, 1) += 1e-3;
  expect_named(matrices);
}

TEST(SubdomainSystem, hinge_is_named)
{
  for (const unsigned int n : {1, 2, 3, 5, 8})
    for (const double skew : {0., 0.1, 0.31})
      {
        SCOPED_TRACE(std::to_string(n) + " cells, skew " + std::to_string(skew));
        const Scene                scene = box(n);
        const mesh::Mesh<2>        mesh  = mesh_of(hinged_squares(n, skew));
        const mechanics::Spaces<2> spaces(mesh, 1);
        expect_named(mechanics::assemble(scene, mesh, spaces, 1.)[0]);
      }
}

TEST(SubdomainSystem, larger_kernel_is_named)
{
  // the corner node of the square hangs on nothing
  auto matrices = square(5);
  for (int column = 0; column < matrices.stiffness.outerSize(); ++column)
    for (Eigen::SparseMatrix<double>::InnerIterator entry(matrices.stiffness, column); entry; ++entry)
      if (entry.row() < 2 || entry.col() < 2)
        entry.valueRef() = 0;
  matrices.kernel.topRows(2).setZero();
  expect_named(matrices);
}

TEST(SubdomainSystem, zero_stiffness_is_named)
{
  auto matrices = square(4);
  matrices.stiffness *= 0.;
  expect_named(matrices);
}

TEST(SubdomainSystem, stiffness_that_is_no_number_is_named)
{
  auto matrices                     = square(4);
  matrices.stiffness.coeffRef(8, 8) = std::numeric_limits<double>::quiet_NaN();
  expect_named(matrices);
}
