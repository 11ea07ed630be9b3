// Points that violate linear inequalities least.
#include <slipstick/tfeti/least_violation.h>

#include <gtest/gtest.h>

using namespace slipstick::tfeti;

namespace
{
  /// Of y >= 0 and y <= -slope x, but for constants: the room of a body under a roof that falls towards x.
  Eigen::MatrixXd wedge(const double slope)
  {
    Eigen::MatrixXd rates(2, 2);
    rates << 0, 1, -slope, -1;
    return rates;
  }

  double violation(const Eigen::VectorXd &values, const Eigen::MatrixXd &rates)
  {
    return (values + rates * least_violation(values, rates)).cwiseMin(0).norm();
  }
} // namespace

TEST(LeastViolation, IsNoneInNarrowWedges)
{
  for (const double slope : {1., 0.1, 1e-2, 1e-4, 1e-6})
    for (const double floor : {0., 1e-3, -1e-3})
      EXPECT_LT(violation(Eigen::Vector2d(floor, -0.02), wedge(slope)), 1e-15) << slope << ' ' << floor;
}

TEST(LeastViolation, IsNoneInCones)
{
  // the cone of all a with n_i'(a - inside) >= 0, n_i random, the same on every machine
  for (const unsigned int n : {3u, 6u, 20u})
    {
      std::uint64_t   state = n;
      Eigen::MatrixXd rates(20 * n, n);
      for (Eigen::Index i = 0; i < rates.rows(); ++i)
        for (Eigen::Index j = 0; j < rates.cols(); ++j)
          {
            state       = state * 6364136223846793005ull + 1442695040888963407ull;
            rates(i, j) = double(state >> 11) / double(1ull << 53) - (j + 1 == rates.cols() ? 0.4 : 0.5);
          }
      const Eigen::VectorXd inside = Eigen::VectorXd::LinSpaced(n, 1, 2);
      const Eigen::VectorXd values = -(rates * inside);
      EXPECT_LT(violation(values, rates), 1e-12) << n;
    }
}

TEST(LeastViolation, IsSharedBetweenContradictions)
{
  // x >= 1 twice and x <= -1, y free: the least squares are at x = 1/3
  Eigen::MatrixXd rates(3, 2);
  rates << 1, 0, 1, 0, -1, 0;
  const Eigen::VectorXd a = least_violation(Eigen::Vector3d(-1, -1, -1), rates);
  EXPECT_NEAR(a[0], 1. / 3, 1e-14);
  EXPECT_EQ(a[1], 0);
}

TEST(LeastViolation, DoesNotDependOnRounding)
{
  // two nodes of a disc that touch a flat floor, one deeper than the other: no rotation lifts the second alone
  Eigen::MatrixXd rates(2, 2);
  rates << 0.5, 0.3, 0.5, 0.3 + 1e-15;
  const Eigen::VectorXd a = least_violation(Eigen::Vector2d(-1e-3, -2e-3), rates);
  EXPECT_NEAR((rates * a)[0], 2e-3, 1e-12);
  EXPECT_LT(a.norm(), 5e-3);
}
