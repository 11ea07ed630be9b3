// Bodies that nothing but contact holds: where forces within bounds balance their loads.
#include "torn.h"

#include <slipstick/tfeti/gathered_by_label.h>

#include <functional>

#include <limits>

using namespace slipstick;
using namespace slipstick::test;

namespace
{
  /// A box on a circle, which nothing but friction keeps from rolling.
  Scene loose_box()
  {
    Scene scene = box(8);
    touch(scene, 0, "bottom", {5, -20}, 20, "100");
    load(scene, 0, "top", "0", "-1");
    return scene;
  }

  /// A box between two held ones, which nothing but friction keeps from leaving sideways.
  Scene stack()
  {
    Scene scene = box(4);
    add_body(scene, "middle", {1, 10}, {8, 5}, {{6, 4}});
    add_body(scene, "upper", {0, 15}, {10, 10}, {{5, 5}});
    support(scene, 0, "bottom", "0", "0");
    support(scene, 2, "top", "0", "-1e-3");
    touch(scene, {1, "bottom"}, {0, "top"}, scene::make_law<2>("Tresca", {"100"}));
    touch(scene, {1, "top"}, {2, "bottom"}, scene::make_law<2>("Tresca", {"100"}));
    return scene;
  }

  /// Numbers in (-1, 1) of a row, whoever owns it.
  double number_of(const std::uint64_t label, const unsigned int seed)
  {
    std::uint64_t state = label * 0x9e3779b97f4a7c15ull + 7919ull * (seed + 1);
    for (unsigned int i = 0; i < 8; ++i)
      {
        state ^= state << 13;
        state ^= state >> 7;
        state ^= state << 17;
      }
    return static_cast<double>(state >> 11) / static_cast<double>(1ull << 52) - 1;
  }

  /// What balance_bodies() makes of random gradients, known to all ranks.
  struct Moved
  {
    Moved(const Scene &scene, const MPI_Comm comm, const unsigned int seed, const double friction)
    {
      const Torn                                  torn(scene, comm);
      const auto                                  dual = torn.dual();
      const auto                                 &rows = dual->constraints();
      const unsigned int                          n    = rows.kind.size();
      qp::AdmissibleSet<tfeti::DistributedVector> bounds{{dual->zero(), dual->zero()}, {}};
      std::vector<double>                         stiffness(n), moved(n);
      for (unsigned int r = 0; r < n; ++r)
        {
          const bool is_tangential          = rows.kind[r] == tfeti::RowKind::tangential;
          const bool is_equality            = tfeti::is_equality(rows.kind[r]);
          bounds.box.lower.local_element(r) = is_equality     ? -qp::infinity
                                              : is_tangential ? -2 - number_of(rows.label[r], seed)
                                                              : 0;
          bounds.box.upper.local_element(r) = is_tangential ? 2 + number_of(rows.label[r], seed) : qp::infinity;
          stiffness[r]                      = 10 * (2 + number_of(rows.label[r], seed + 1000));
          moved[r]                          = 5 * number_of(rows.label[r], seed + 2000);
        }
      for (const auto &point : rows.contact_points)
        if (friction > 0 && point.tangential_row != tfeti::invalid_row)
          bounds.pressure_bounds.push_back({point.tangential_row, point.normal_row, {0., friction}});
      dual->loose_bodies().balance(stiffness, bounds, 0.01, moved);

      auto forces = dual->zero();
      for (unsigned int r = 0; r < n; ++r)
        forces.local_element(r) =
          tfeti::is_equality(rows.kind[r])
            ? 0.
            : qp::clip(moved[r], bounds.box.lower.local_element(r), bounds.box.upper.local_element(r));
      for (const auto &bound : bounds.pressure_bounds)
        {
          const double radius                    = bound.forces.radius(forces.local_element(bound.normal));
          forces.local_element(bound.tangential) = qp::clip(moved[bound.tangential], -radius, radius);
        }
      size = forces.l1_norm();
      for (const auto &motion : {Motion([](const Point &) {
                                   return Point{1., 0.};
                                 }),
                                 Motion([](const Point &) {
                                   return Point{0., 1.};
                                 }),
                                 Motion([](const Point &at) {
                                   return Point{-at[1], at[0]};
                                 })})
        {
          std::vector<Eigen::VectorXd> u;
          double                       load = 0;
          for (unsigned int p = 0; p < torn.matrices.size(); ++p)
            {
              const auto at = node_positions(torn.spaces, p);
              u.emplace_back(Eigen::VectorXd::Zero(2 * at.size()));
              for (unsigned int i = 0; i < at.size() && torn.matrices[p].body == free_body(scene); ++i)
                for (unsigned int c = 0; c < 2; ++c)
                  u.back()[2 * i + c] = motion(at[i])[c];
              load += u.back().dot(torn.matrices[p].load);
            }
          const double bears = dual->dual_operator().jumps(u) * forces;
          largest_load       = std::max(largest_load, std::abs(dealii::Utilities::MPI::sum(load, comm)));
          missing.push_back(dealii::Utilities::MPI::sum(load, comm) - bears);
        }
      std::vector<std::uint64_t> labels(rows.label.begin(), rows.label.begin() + n);
      const auto                 all_labels = gathered(labels, comm);
      const auto                 all_moved  = gathered(moved, comm);
      for (unsigned int i = 0; i < all_labels.size(); ++i)
        by_label[all_labels[i]] = all_moved[i];
    }

    using Motion = std::function<Point(const Point &)>;

    static unsigned int free_body(const Scene &scene)
    {
      return scene.bodies.size() > 1 ? 1 : 0;
    }

    std::vector<double>             missing; // of the loads along x, y and in rotation
    double                          size = 0, largest_load = 0;
    std::map<std::uint64_t, double> by_label;
  };
} // namespace

TEST(LooseBodies, are_where_clipped_forces_balance_their_loads)
{
  for (const Scene &scene : {loose_box(), stack()})
    for (const Cut &how : {whole(), blocks(2)})
      for (const double friction : {0., 0.3})
        for (unsigned int seed = 0; seed < 3; ++seed)
          {
            const Moved moved(cut(scene, how), MPI_COMM_WORLD, seed, friction);
            EXPECT_TRUE(moved.size > 1 || friction > 0) << seed; // there is something to balance
            // 1 % of all forces is left; those of the rotation have arms of some 20 mm
            for (unsigned int m = 0; m < moved.missing.size(); ++m)
              EXPECT_NEAR(moved.missing[m], 0., 0.01 * (2 * moved.size * (m < 2 ? 1. : 20.) + moved.largest_load))
                << "friction " << friction << ", seed " << seed;
          }
}

TEST(LooseBodies, are_in_the_same_place_on_any_number_of_ranks)
{
  const Scene scene = cut(stack(), metis(3));
  const Moved alone(scene, MPI_COMM_SELF, 1, 0.3);
  for (unsigned int n = 1; n <= dealii::Utilities::MPI::n_mpi_processes(MPI_COMM_WORLD); ++n)
    {
      const unsigned int rank = dealii::Utilities::MPI::this_mpi_process(MPI_COMM_WORLD);
      MPI_Comm           comm;
      MPI_Comm_split(MPI_COMM_WORLD, rank < n, rank, &comm); // the others do the same among themselves
      {
        const Moved moved(scene, comm, 1, 0.3);
        ASSERT_EQ(moved.by_label.size(), alone.by_label.size()) << n;
        for (const auto &[label, value] : alone.by_label)
          EXPECT_NEAR(moved.by_label.at(label), value, 1e-9 * std::max(1., std::abs(value))) << n;
      }
      MPI_Comm_free(&comm);
    }
}

TEST(LooseBodies, stay_where_supports_hold_them)
{
  Scene scene = loose_box();
  support(scene, 0, "left", "0", "0");
  const Torn                                        torn(cut(scene, blocks(2)), MPI_COMM_WORLD);
  const auto                                        dual = torn.dual();
  const std::vector<double>                         stiffness(torn.constraints.kind.size(), 1.);
  std::vector<double>                               moved(stiffness.size(), 1.);
  const qp::AdmissibleSet<tfeti::DistributedVector> bounds{{dual->zero(), dual->zero()}, {}};
  dual->loose_bodies().balance(stiffness, bounds, 0.01, moved);
  EXPECT_EQ(moved, stiffness);
}

TEST(LooseBodies, are_held_by_the_row_that_is_nearest_to_its_bound)
{
  const Torn          torn(cut(stack(), blocks(2)), MPI_COMM_WORLD);
  const auto          dual = torn.dual();
  const unsigned int  n    = torn.constraints.kind.size();
  std::vector<bool>   free(n);
  std::vector<double> gaps(n, 0.);
  double              least = 1;
  for (unsigned int r = 0; r < n; ++r)
    {
      free[r] = torn.constraints.kind[r] != tfeti::RowKind::tangential;
      gaps[r] = free[r] ? 0. : std::abs(number_of(torn.constraints.label[r], 7));
      least   = free[r] ? least : std::min(least, gaps[r]);
    }
  least              = dealii::Utilities::MPI::min(least, MPI_COMM_WORLD);
  const auto   holds = dual->loose_bodies().hold(free, gaps, false);
  unsigned int added = 0;
  for (unsigned int r = 0; r < n; ++r)
    if (holds[r] != free[r])
      {
        ++added;
        EXPECT_EQ(gaps[r], least);
      }
  EXPECT_EQ(dealii::Utilities::MPI::sum(added, MPI_COMM_WORLD), 1u);
  EXPECT_EQ(dual->loose_bodies().hold(holds, gaps, false), holds);
}

TEST(GatheredByLabel, labels_must_differ)
{
  const std::vector<double> values = {1, 2};
  EXPECT_THROW(tfeti::gathered_by_label({5, 5}, values, MPI_COMM_WORLD), dealii::ExceptionBase);
  const std::uint64_t rank = dealii::Utilities::MPI::this_mpi_process(MPI_COMM_WORLD);
  const auto          all  = tfeti::gathered_by_label({2 * rank + 1, 2 * rank}, values, MPI_COMM_WORLD);
  EXPECT_EQ(all.size(), 2 * dealii::Utilities::MPI::n_mpi_processes(MPI_COMM_WORLD));
  EXPECT_EQ(all.begin()->second, 2.);
}
