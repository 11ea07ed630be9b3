#include "torn.h"

using namespace slipstick;
using namespace slipstick::test;

namespace
{
  /// A box whose lower corners are far from a circle.
  Scene box_on_small_circle()
  {
    Scene scene = cut(box(16), blocks(2));
    support(scene, 0, "left", "0", "0");
    load(scene, 0, "top", "10", "-100");
    touch(scene, 0, "bottom", {5, -5}, 5, "");
    return scene;
  }

  double distance(tfeti::DistributedVector x, const tfeti::DistributedVector &y)
  {
    x -= y;
    return x.linfty_norm();
  }
} // namespace

TEST(Subdomains, those_touched_elsewhere_alone_are_factorised_again)
{
  const Torn torn(box_on_small_circle());
  const auto pairs = interface::pair_bodies(torn.scene, torn.mesh, torn.spaces);
  const auto rows  = [&](const double part) {
    return interface::contact_rows(torn.scene, torn.mesh, torn.spaces, pairs, 1., part).active;
  };
  for (const auto kind : {tfeti::DualOperatorKind::implicit, tfeti::DualOperatorKind::explicit_blocks})
    for (const bool keeps_factors : {true, false})
      {
        tfeti::DualOptions options;
        options.dual_operator  = kind;
        options.keeps_factors  = keeps_factors;
        options.preconditioner = tfeti::Preconditioner::dirichlet;
        const auto subdomains  = std::make_shared<tfeti::Subdomains>(torn.matrices);
        const auto problem_on  = [&](const tfeti::Constraints &constraints) {
          return tfeti::DualProblem(subdomains, constraints, options, body_names(torn.scene), torn.comm);
        };
        const auto n_factorizations = [&] {
          return dealii::Utilities::MPI::sum(subdomains->n_factorizations(), torn.comm);
        };
        for (unsigned int k = 0; k < 2; ++k)
          {
            const auto few = problem_on(rows(0.));
            ASSERT_LT(few.constraints().counts.normal, torn.constraints.counts.normal);
            EXPECT_EQ(n_factorizations(), 4u) << "all, once";
          }
        auto all = problem_on(torn.constraints);
        EXPECT_EQ(n_factorizations(), 6u) << "the lower two of four";

        auto       fresh = torn.dual(options);
        const auto x     = distributed(random_vector(torn.constraints.rows->size(), 1), all);
        auto       one = all.zero(), other = all.zero();
        all.multiply(x, one);
        fresh->multiply(x, other);
        EXPECT_EQ(distance(one, other), 0.);
        EXPECT_EQ(distance(all.d(), fresh->d()), 0.);
        const std::vector<bool> free(torn.constraints.kind.size(), true);
        all.face(free).precondition(x, one);
        fresh->face(free).precondition(x, other);
        EXPECT_EQ(distance(one, other), 0.);
        std::vector<Eigen::VectorXd> loads;
        for (const auto &matrices : torn.matrices)
          loads.push_back(-2 * matrices.load);
        all.set_step(loads, torn.constraints.c);
        fresh->set_step(loads, torn.constraints.c);
        EXPECT_EQ(distance(all.d(), fresh->d()), 0.);
      }
}
