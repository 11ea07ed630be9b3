// Closing of the gaps that a solution leaves open.
#include "solved.h"

#include <slipstick/contact/refinement.h>

using namespace slipstick;
using namespace slipstick::test;

namespace
{
  /// Of all ranks.
  double norm_of_misfit(const tfeti::DualProblem &dual, const tfeti::Recovery &of, const std::vector<bool> &free)
  {
    return tfeti::misfit(dual, of, free).l2_norm();
  }

  double largest_difference(const std::vector<Eigen::VectorXd> &a, const std::vector<Eigen::VectorXd> &b)
  {
    double largest = 0;
    for (unsigned int p = 0; p < a.size(); ++p)
      largest = std::max(largest, (a[p] - b[p]).lpNorm<Eigen::Infinity>());
    return dealii::Utilities::MPI::max(largest, MPI_COMM_WORLD);
  }
} // namespace

TEST(CloseGaps, leads_from_a_rough_answer_to_the_accurate_one_on_its_set)
{
  for (const bool has_contact : {false, true})
    for (const Cut &how : {blocks(4), metis(5)})
      {
        Scene scene            = cut(has_contact ? box_on_circle(8, "500") : bent_box(8), how);
        scene.solver.tolerance = 1e-12;
        const Solved accurate(scene);
        const auto   recovery = tfeti::recover(*accurate.dual, accurate.solution.multipliers, accurate.solution.free);

        // multipliers off by some percent, balanced: displacements that leave gaps open
        const auto  &free  = accurate.solution.free;
        auto         x     = accurate.solution.multipliers;
        const auto   noise = distributed(random_vector(x.size(), 1), *accurate.dual);
        const double size  = x.linfty_norm(); // collective
        for (unsigned int r = 0; r < free.size(); ++r)
          if (free[r])
            x.local_element(r) += 0.03 * size * noise.local_element(r);
        auto         rough = tfeti::recover(*accurate.dual, x, free);
        const double open  = norm_of_misfit(*accurate.dual, rough, free);
        const double off   = largest_difference(rough.u, recovery.u);
        const auto   work  = contact::close_gaps(*accurate.dual, free, scene.solver.pcpg, rough);
        EXPECT_GT(work.hessian_multiplications, 0u);
        EXPECT_GT(open, 1e6 * norm_of_misfit(*accurate.dual, recovery, free));
        EXPECT_LT(norm_of_misfit(*accurate.dual, rough, free), 1e-2 * open);
        EXPECT_LT(largest_difference(rough.u, recovery.u), 1e-2 * off);
      }
}

TEST(CloseGaps, leaves_bodies_alone_that_slide_on_all_their_contacts)
{
  for (const Cut &how : {whole(), blocks(2)})
    {
      const Sliding sliding(how, "0", 0);
      auto          recovery = tfeti::recover(*sliding.dual, sliding.x, sliding.free, true);
      const auto    before   = recovery.u;
      const auto    work     = contact::close_gaps(*sliding.dual, sliding.free, {}, recovery);
      EXPECT_EQ(work.hessian_multiplications, 0u);
      EXPECT_EQ(largest_difference(before, recovery.u), 0);
    }
}
