// Bodies that slide on all contacts: where they come to rest at given forces.
#include "torn.h"

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

  struct Row
  {
    double g, capacity, force, share; // share: jump in the motion
    double shift;
    bool   holds;
  };
  using Rows = std::map<std::uint64_t, Row>; // tangential ones, by label

  /// All slip at random bounds and gradients; what settle() makes of it, known to all ranks.
  struct Sliding
  {
    template <typename Motion>
    Sliding(const Scene &scene, const MPI_Comm comm, const unsigned int seed, const Motion &motion)
    {
      const Torn          torn(scene, comm);
      const auto          dual = torn.dual();
      const unsigned int  n    = torn.constraints.kind.size();
      std::vector<bool>   free(n);
      std::vector<double> capacity(n, std::numeric_limits<double>::infinity());
      auto                x = dual->zero(), g = dual->zero();
      for (unsigned int r = 0; r < n; ++r)
        {
          const auto label = torn.constraints.label[r];
          free[r]          = torn.constraints.kind[r] != tfeti::RowKind::tangential;
          if (free[r])
            continue;
          capacity[r]        = 2 + number_of(label, seed);
          g.local_element(r) = number_of(label, seed + 1000);
          x.local_element(r) = 0.3 * number_of(label, seed + 2000) * capacity[r];
        }
      const auto                   settled = dual->settle(free, capacity, x, g, false);
      std::vector<Eigen::VectorXd> u;
      for (unsigned int p = 0; p < torn.matrices.size(); ++p)
        {
          const auto at = node_positions(torn.spaces, p);
          u.emplace_back(2 * at.size());
          for (unsigned int i = 0; i < at.size(); ++i)
            for (unsigned int c = 0; c < 2; ++c)
              u.back()[2 * i + c] = motion(torn.matrices[p].body, at[i])[c];
        }
      const auto                         share = dual->jumps(u);
      std::vector<std::uint64_t>         labels;
      std::vector<std::array<double, 6>> values;
      for (unsigned int r = 0; r < n; ++r)
        {
          if (free[r])
            {
              others += std::abs(settled.shift.local_element(r)) + !settled.free[r];
              continue;
            }
          labels.push_back(torn.constraints.label[r]);
          values.push_back({{g.local_element(r),
                             capacity[r],
                             x.local_element(r),
                             share.local_element(r),
                             settled.shift.local_element(r),
                             settled.free[r] ? 1. : 0.}});
        }
      is_loose              = settled.is_loose;
      const auto all_labels = gathered(labels, comm);
      const auto all_values = gathered(values, comm);
      for (unsigned int i = 0; i < all_labels.size(); ++i)
        {
          const auto &v       = all_values[i];
          rows[all_labels[i]] = {v[0], v[1], v[2], v[3], v[4], v[5] == 1};
        }
    }

    /// The row at which sum r |g + S a| + a sum x S is least, by trying all.
    std::uint64_t median() const
    {
      std::uint64_t best  = 0;
      double        least = std::numeric_limits<double>::max();
      for (const auto &[label, row] : rows)
        {
          const double a     = -row.g / row.share;
          double       value = 0;
          for (const auto &[other, at] : rows)
            value += at.capacity * std::abs(at.g + at.share * a) + at.force * at.share * a;
          if (value < least)
            {
              least = value;
              best  = label;
            }
        }
      return best;
    }

    Rows   rows;
    bool   is_loose = false;
    double others   = 0; // changes of rows that were free
  };

  Point rolling(const unsigned int, const Point &at)
  {
    return {20 + at[1], 5 - at[0]}; // about (5, -20)
  }

  Point leaving(const unsigned int body, const Point &)
  {
    return {body == 1 ? 1. : 0., 0.};
  }

  void expect_median(const Sliding &sliding, const std::string &where)
  {
    ASSERT_TRUE(sliding.is_loose) << where;
    const auto   held = sliding.median();
    const auto  &at   = sliding.rows.at(held);
    const double a    = -at.g / at.share;
    unsigned int n    = 0;
    for (const auto &[label, row] : sliding.rows)
      {
        n += row.holds;
        EXPECT_NEAR(row.shift, a * row.share, 1e-4) << where; // of gradients of size 1, by the smoothing
      }
    EXPECT_TRUE(at.holds) << where;
    EXPECT_EQ(n, 1u) << where;
  }
} // namespace

TEST(LooseBodies, settle_at_the_weighted_median_of_what_slides)
{
  for (const Cut &how : {whole(), blocks(2)})
    for (unsigned int seed = 0; seed < 4; ++seed)
      {
        const Sliding sliding(cut(loose_box(), how), MPI_COMM_WORLD, seed, rolling);
        EXPECT_EQ(sliding.others, 0.) << seed;
        expect_median(sliding, "seed " + std::to_string(seed));
      }
}

TEST(LooseBodies, settle_between_two_bodies)
{
  for (const Cut &how : {whole(), blocks(2)})
    for (unsigned int seed = 0; seed < 2; ++seed)
      expect_median(Sliding(cut(stack(), how), MPI_COMM_WORLD, seed, leaving), "seed " + std::to_string(seed));
}

TEST(LooseBodies, settle_alike_on_any_number_of_ranks)
{
  const Scene   scene = cut(stack(), metis(3));
  const Sliding alone(scene, MPI_COMM_SELF, 1, leaving);
  for (unsigned int n = 1; n <= dealii::Utilities::MPI::n_mpi_processes(MPI_COMM_WORLD); ++n)
    {
      const unsigned int rank = dealii::Utilities::MPI::this_mpi_process(MPI_COMM_WORLD);
      MPI_Comm           comm;
      MPI_Comm_split(MPI_COMM_WORLD, rank < n, rank, &comm); // the others do the same among themselves
      {
        const Sliding sliding(scene, comm, 1, leaving);
        ASSERT_EQ(sliding.rows.size(), alone.rows.size()) << n;
        for (const auto &[label, row] : alone.rows)
          {
            EXPECT_EQ(sliding.rows.at(label).holds, row.holds) << n;
            EXPECT_NEAR(sliding.rows.at(label).shift, row.shift, 1e-8) << n;
          }
      }
      MPI_Comm_free(&comm);
    }
}

TEST(LooseBodies, nothing_settles_where_all_is_held)
{
  Scene scene = loose_box();
  support(scene, 0, "left", "0", "0");
  const Sliding sliding(cut(scene, blocks(2)), MPI_COMM_WORLD, 1, rolling);
  EXPECT_FALSE(sliding.is_loose);
  for (const auto &[label, row] : sliding.rows)
    EXPECT_TRUE(row.shift == 0 && !row.holds);
}
