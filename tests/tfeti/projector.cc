#include "torn.h"

#include <slipstick/tfeti/projector.h>

using namespace slipstick;
using namespace slipstick::test;

namespace
{
  std::vector<std::pair<std::string, Scene>> scenes()
  {
    return {{"one subdomain", box_on_circle(4, "100")},
            {"blocks", cut(box_on_circle(6, "100"), blocks(3))},
            {"METIS", cut(box_on_circle(7, "100"), metis(5))},
            {"two bodies", cut(two_bodies(4), blocks(2))}};
  }

  /// The projector of a torn problem on a part of its rows, with the dense matrices beside it.
  struct Projection
  {
    explicit Projection(const Scene &scene, const std::function<bool(tfeti::RowKind)> &takes_part = {})
      : torn(scene)
      , dense(torn)
      , dual(torn.dual())
    {
      for (const auto &block : torn.constraints.blocks)
        gluing.push_back(tfeti::LocalGluing::make(block).first);
      std::vector<bool> stays;
      for (const auto kind : torn.constraints.kind)
        stays.push_back(tfeti::is_equality(kind) && (!takes_part || takes_part(kind)));
      projector = std::make_unique<tfeti::Projector>(dual->subdomains(),
                                                     gluing,
                                                     dual->dual_operator(),
                                                     torn.constraints.rows,
                                                     stays,
                                                     MPI_COMM_WORLD);
      if (!takes_part)
        return;
      for (const auto kind : torn.constraints.kind)
        active.push_back(takes_part(kind));
      for (unsigned int r = 0; r < dense.kind.size(); ++r)
        if (!takes_part(dense.kind[r]))
          dense.G.col(r).setZero();
      all       = std::move(projector);
      projector = std::make_unique<tfeti::Projector>(*all, active, MPI_COMM_WORLD);
    }

    Eigen::VectorXd Q(const Eigen::VectorXd &x) const
    {
      auto y = dual->zero();
      projector->project_range(distributed(x, *dual), y);
      return gathered(y, MPI_COMM_WORLD);
    }

    Eigen::VectorXd P(const Eigen::VectorXd &x) const
    {
      return x - Q(x);
    }

    Eigen::VectorXd random(const unsigned int seed) const
    {
      return random_vector(dense.B.rows(), seed);
    }

    /// This rank's part of numbers that go with the rigid motions.
    Eigen::VectorXd own_motions(const Eigen::VectorXd &all) const
    {
      return all.segment(3 * torn.mesh.first_subdomain[dealii::Utilities::MPI::this_mpi_process(MPI_COMM_WORLD)],
                         3 * torn.mesh.subdomains.size());
    }

    Torn                                torn;
    Dense                               dense;
    std::unique_ptr<tfeti::DualProblem> dual;
    std::vector<tfeti::LocalGluing>     gluing;
    std::vector<bool>                   active;
    std::unique_ptr<tfeti::Projector>   all, projector;
  };

  const auto equality = [](const tfeti::RowKind kind) {
    return kind == tfeti::RowKind::gluing || kind == tfeti::RowKind::prescribed;
  };
} // namespace

TEST(Projector, is_idempotent)
{
  for (const auto &[name, scene] : scenes())
    {
      const Projection      tested(scene);
      const Eigen::VectorXd x = tested.random(1), Px = tested.P(x);
      EXPECT_LT((tested.P(Px) - Px).norm(), 1e-13 * x.norm()) << name;
    }
}

TEST(Projector, is_symmetric)
{
  for (const auto &[name, scene] : scenes())
    {
      const Projection      tested(scene);
      const Eigen::VectorXd x = tested.random(1), y = tested.random(2);
      EXPECT_LT(std::abs(y.dot(tested.P(x)) - x.dot(tested.P(y))), 1e-13 * x.norm() * y.norm()) << name;
    }
}

TEST(Projector, maps_into_the_kernel_of_G)
{
  for (const auto &[name, scene] : scenes())
    {
      const Projection      tested(scene);
      const Eigen::VectorXd x = tested.random(1);
      EXPECT_LT((tested.dense.G * tested.P(x)).norm(), 1e-13 * tested.dense.G.norm() * x.norm()) << name;
    }
}

TEST(Projector, keeps_the_range_of_G_transposed)
{
  for (const auto &[name, scene] : scenes())
    {
      const Projection      tested(scene);
      const Eigen::VectorXd x = tested.dense.G.transpose() * random_vector(tested.dense.G.rows(), 5);
      EXPECT_LT(relative_difference(tested.Q(x), x), 1e-12) << name;
    }
}

TEST(Projector, agrees_with_a_dense_one_on_active_rows)
{
  for (const auto &[name, scene] : scenes())
    for (const bool with_mask : {false, true})
      {
        const Projection      tested(scene, with_mask ? equality : std::function<bool(tfeti::RowKind)>());
        const Eigen::VectorXd x = tested.random(1);
        EXPECT_LT((tested.P(x) - tested.dense.P() * x).norm(), 1e-12 * x.norm()) << name << ", mask " << with_mask;
      }
}

TEST(Projector, restrictions_of_one_projector_agree_with_dense_ones_in_any_order)
{
  const auto no_friction = [](const tfeti::RowKind kind) { return kind != tfeti::RowKind::tangential; };
  const auto all         = [](const tfeti::RowKind) { return true; };
  for (const auto &[name, scene] : scenes())
    {
      const Projection      tested(scene, equality);
      const Dense           whole(tested.torn);
      const Eigen::VectorXd x = tested.random(1);
      for (const auto &takes_part : std::vector<std::function<bool(tfeti::RowKind)>>{all, equality, no_friction, all})
        {
          std::vector<bool> active;
          for (const auto kind : tested.torn.constraints.kind)
            active.push_back(takes_part(kind));
          Eigen::MatrixXd G = whole.G;
          for (unsigned int r = 0; r < whole.kind.size(); ++r)
            if (!takes_part(whole.kind[r]))
              G.col(r).setZero();
          const tfeti::Projector restricted(*tested.all, active, MPI_COMM_WORLD);
          auto                   y = tested.dual->zero();
          restricted.project_range(distributed(x, *tested.dual), y);
          const Eigen::VectorXd Qx = G.transpose() * (G * G.transpose()).ldlt().solve(G * x);
          EXPECT_LT((gathered(y, MPI_COMM_WORLD) - Qx).norm(), 1e-12 * x.norm()) << name;
        }
    }
}

TEST(Projector, particular_solution_is_the_smallest_one)
{
  for (const auto &[name, scene] : scenes())
    for (const bool with_mask : {false, true})
      {
        const Projection tested(scene, with_mask ? equality : std::function<bool(tfeti::RowKind)>());
        auto             x = tested.dual->zero();
        tested.projector->particular(tested.own_motions(tested.dense.e), x);
        const Eigen::VectorXd all = gathered(x, MPI_COMM_WORLD);
        EXPECT_LT(relative_difference(tested.dense.G * all, tested.dense.e), 1e-11) << name << ", mask " << with_mask;
        EXPECT_LT((tested.dense.P() * all).norm(), 1e-11 * all.norm()) << name << ", mask " << with_mask;
      }
}

TEST(Projector, amplitudes_are_those_of_the_range_part)
{
  for (const auto &[name, scene] : scenes())
    {
      const Projection      tested(scene, equality);
      const Eigen::VectorXd a = random_vector(tested.dense.G.rows(), 3), x = tested.dense.G.transpose() * a;
      const auto            own = tested.projector->amplitudes(distributed(x, *tested.dual));
      EXPECT_LT((own - tested.own_motions(a)).norm(), 1e-11 * a.norm()) << name;
    }
}

TEST(Projector, dimension_is_three_a_subdomain)
{
  for (const auto &[name, scene] : scenes())
    {
      const Projection tested(scene);
      EXPECT_EQ(tested.projector->dimension(), 3 * tested.torn.mesh.n_subdomains()) << name;
    }
}
