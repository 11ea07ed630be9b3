#include "closing.h"

#include <slipstick/contact/refinement.h>

#include <deal.II/base/mpi.h>

#include <gtest/gtest.h>

#include <cmath>

namespace slipstick::test
{
  namespace
  {
    // Relative to the largest multiplier.
    constexpr double disturbance = 0.03;
    // Admissible remainder of gaps and errors; gaps are closed to 1e-4.
    constexpr double left = 1e-2;
    // The same with directions of earlier solves; gaps are closed to 1e-2.
    constexpr double left_with_store = 0.1;

    double largest_difference(const std::vector<Eigen::VectorXd> &a, const std::vector<Eigen::VectorXd> &b)
    {
      double largest = 0;
      for (unsigned int p = 0; p < a.size(); ++p)
        largest = std::max(largest, (a[p] - b[p]).lpNorm<Eigen::Infinity>());
      return dealii::Utilities::MPI::max(largest, MPI_COMM_WORLD);
    }

    /// Disturbs the free multipliers, in the same way for any number of ranks.
    tfeti::DistributedVector disturbed(const contact::DualSolution &accurate, const tfeti::DualProblem &dual)
    {
      tfeti::DistributedVector x    = accurate.multipliers;
      const double             size = x.linfty_norm(); // collective
      for (unsigned int r = 0; r < accurate.free.size(); ++r)
        if (accurate.free[r])
          x.local_element(r) += disturbance * size * std::sin(1e3 * std::fmod(dual.constraints().label[r], 1009.));
      return x;
    }
  } // namespace

  unsigned int expect_closing_leads_to(const contact::DualSolution &accurate,
                                       const tfeti::DualProblem    &dual,
                                       const contact::SlipLaw      &law)
  {
    const auto  &free     = accurate.free;
    const auto   recovery = tfeti::recover(dual, accurate.multipliers, free);
    auto         rough    = tfeti::recover(dual, disturbed(accurate, dual), free);
    const double open     = tfeti::misfit(dual, rough, free).l2_norm();
    const double off      = largest_difference(rough.u, recovery.u);
    const auto   work     = contact::close_gaps(dual, law, free, {}, rough);
    EXPECT_GT(work.hessian_multiplications, 0u);
    EXPECT_GT(open, 1e6 * tfeti::misfit(dual, recovery, free).l2_norm());
    EXPECT_LT(tfeti::misfit(dual, rough, free).l2_norm(), left * open);
    EXPECT_LT(largest_difference(rough.u, recovery.u), left * off);

    if (accurate.directions)
      {
        auto again = tfeti::recover(dual, disturbed(accurate, dual), free);
        contact::close_gaps(dual, law, free, {}, again, accurate.directions.get());
        EXPECT_LT(tfeti::misfit(dual, again, free).l2_norm(), left_with_store * open);
        EXPECT_LT(largest_difference(again.u, recovery.u), left_with_store * off);
      }

    unsigned int n_slipping = 0;
    const auto   bounds     = law.bounds(rough.multipliers);
    for (const auto &bound : law.pressure_bounds())
      if (free[bound.normal] && !free[bound.tangential])
        {
          const auto  &x = rough.multipliers;
          const double t =
            std::hypot(x.local_element(bound.tangential), bound.is_disc() ? x.local_element(bound.second) : 0.);
          EXPECT_NEAR(t / bounds[bound.tangential], 1, 1e-12);
          ++n_slipping;
        }
    return dealii::Utilities::MPI::sum(n_slipping, MPI_COMM_WORLD);
  }
} // namespace slipstick::test
