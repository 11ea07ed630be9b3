// Closing of the gaps that a solution leaves open.
#include "closing.h"
#include "solved.h"

#include <slipstick/contact/refinement.h>

using namespace slipstick;
using namespace slipstick::test;

TEST(CloseGaps, leads_from_a_rough_answer_to_the_accurate_one_on_its_set)
{
  for (const bool has_contact : {false, true})
    for (const Cut &how : {blocks(4), metis(5)})
      {
        Scene scene            = cut(has_contact ? box_on_circle(8, "500") : bent_box(8), how);
        scene.solver.tolerance = 1e-12;
        const Solved accurate(scene);
        expect_closing_leads_to(accurate.solution, *accurate.dual, contact::SlipLaw(scene, *accurate.dual, 1.));
      }
}

TEST(CloseGaps, lets_slip_forces_follow_the_pressures)
{
  for (const Cut &how : {blocks(4), metis(5)})
    {
      Scene scene            = cut(box_on_circle(8, "0"), how);
      scene.contacts[0].law  = scene::make_law<2>("Coulomb", {"0.05"});
      scene.solver.tolerance = 1e-10;
      const Torn             torn(scene);
      const auto             dual = torn.dual(contact::resolved_options(scene).dual);
      const contact::SlipLaw law(scene, *dual, 1.);
      const auto solution = contact::solve(*dual, law, contact::resolved_options(scene), scene.friction, {});
      ASSERT_EQ(solution.status, qp::Status::converged);
      EXPECT_GE(expect_closing_leads_to(solution, *dual, law), 1u);
    }
}

TEST(CloseGaps, leaves_bodies_alone_that_slide_on_all_their_contacts)
{
  for (const Cut &how : {whole(), blocks(2)})
    {
      const Sliding          sliding(how, "0", 0);
      auto                   recovery = tfeti::recover(*sliding.dual, sliding.x, sliding.free, true);
      const auto             before   = recovery.u;
      const contact::SlipLaw law(Sliding::scene("0"), *sliding.dual, 1.);
      const auto             work = contact::close_gaps(*sliding.dual, law, sliding.free, {}, recovery);
      EXPECT_EQ(work.hessian_multiplications, 0u);
      for (unsigned int p = 0; p < before.size(); ++p)
        EXPECT_EQ((before[p] - recovery.u[p]).lpNorm<Eigen::Infinity>(), 0);
    }
}
