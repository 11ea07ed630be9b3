// Entries distributed over threads that meet in reductions: each thread obtains the same result, which is the serial
// one.
#include "support.h"

#include <slipstick/qp/smalbe.h>

#include <condition_variable>
#include <mutex>
#include <thread>

using namespace slipstick::qp;
using namespace slipstick::qp::test;

namespace
{
  /// Sums over a team of threads, in the order of their ranks.
  class Team
  {
  public:
    explicit Team(const std::size_t size)
      : contributions(size)
    {}

    template <typename Combine>
    Vector gather(const std::size_t rank, const Vector &mine, const Combine &combine)
    {
      std::unique_lock<std::mutex> lock(mutex);
      contributions[rank]   = mine;
      const auto generation = n_rounds;
      if (++n_arrived == contributions.size())
        {
          n_arrived = 0;
          total     = combine(contributions);
          ++n_rounds;
          all_arrived.notify_all();
        }
      else
        all_arrived.wait(lock, [&] { return n_rounds != generation; });
      return total;
    }

  private:
    std::mutex              mutex;
    std::condition_variable all_arrived;
    std::vector<Vector>     contributions;
    Vector                  total;
    std::size_t             n_arrived = 0, n_rounds = 0;
  };

  Vector add_up(const std::vector<Vector> &parts)
  {
    Vector sum(parts[0].size(), 0.0);
    for (const Vector &part : parts)
      add(1.0, part, sum);
    return sum;
  }

  struct TeamReduction
  {
    template <std::size_t n>
    std::array<double, n> sum(const std::array<double, n> &values) const
    {
      const Vector          total = team.gather(rank, Vector(values.begin(), values.end()), add_up);
      std::array<double, n> result{};
      std::copy(total.begin(), total.end(), result.begin());
      return result;
    }

    double min(const double value) const
    {
      return team.gather(rank, {value}, [](const std::vector<Vector> &parts) {
        return *std::min_element(parts.begin(), parts.end());
      })[0];
    }

    Team       &team;
    std::size_t rank;
  };

  /// The entries [first, first + size) of a dense problem.
  struct SplitProblem
  {
    // All entries, gathered from the parts; the team waits for its members, so that the serial problem is only read.
    Vector whole(const Vector &x) const
    {
      Vector padded(serial.F.n, 0.0);
      std::copy(x.begin(), x.end(), padded.begin() + first);
      return team_reduction.team.gather(team_reduction.rank, padded, add_up);
    }

    void take(const Vector &all, Vector &y) const
    {
      std::copy_n(all.begin() + first, y.size(), y.begin());
    }

    void multiply(const Vector &x, Vector &y) const
    {
      take(serial.F * whole(x), y);
    }

    void project_range(const Vector &x, Vector &y) const
    {
      DenseProblem copy(serial.F, serial.G);
      take(copy.range(whole(x)), y);
    }

    const TeamReduction &reduction() const
    {
      return team_reduction;
    }

    const DenseProblem &serial;
    TeamReduction       team_reduction;
    std::ptrdiff_t      first;
  };
} // namespace

class SplitVector : public testing::TestWithParam<Expansion>
{};

INSTANTIATE_TEST_SUITE_P(AllExpansions, SplitVector, testing::ValuesIn(all_expansions));

TEST_P(SplitVector, smalbe_on_three_threads_gives_the_serial_solution)
{
  Random        random(1);
  DenseProblem  problem(random.semidefinite(20, 20, 0.05), random.orthonormal(3, 20));
  const double  norm = spectral_norm(problem.F);
  const auto    box  = random.box(20, true);
  const Vector  b    = problem.kernel(random.vector(20));
  SmalbeOptions options;
  options.inner.expansion = GetParam();
  const auto serial       = smalbe(problem, norm, b, box, SmalbeStart<Vector>{Vector(20, 0.0)}, 1e-9, options);

  const std::vector<std::ptrdiff_t> first{0, 13, 13, 20}; // one member owns nothing
  Team                              team(3);
  std::vector<Vector>               parts(3);
  std::vector<Status>               status(3);
  std::vector<std::thread>          members;
  for (std::size_t rank = 0; rank < 3; ++rank)
    members.emplace_back([&, rank] {
      const auto part = [&](const Vector &v) { return Vector(v.begin() + first[rank], v.begin() + first[rank + 1]); };
      const SplitProblem mine{problem, {team, rank}, first[rank]};
      const Box<Vector>  my_box{part(box.lower), part(box.upper)};
      const Vector       my_b = part(b);
      auto result  = smalbe(mine, norm, my_b, my_box, SmalbeStart<Vector>{Vector(my_b.size(), 0.0)}, 1e-9, options);
      parts[rank]  = std::move(result.x);
      status[rank] = result.status;
    });
  for (auto &member : members)
    member.join();

  Vector x;
  for (const Vector &part : parts)
    x.insert(x.end(), part.begin(), part.end());
  ASSERT_EQ(serial.status, Status::converged);
  EXPECT_EQ(status, std::vector<Status>(3, Status::converged));
  EXPECT_LT(distance(x, serial.x), 1e-8);
}
