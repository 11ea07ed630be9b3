// The line search of the semismooth Newton method for a known residual, and its history of sets.
#include "support.h"

#include <slipstick/qp/line_search.h>
#include <slipstick/qp/set_history.h>

#include <cmath>
#include <utility>

using namespace slipstick::qp;
using namespace slipstick::qp::test;

namespace
{
  /// The natural residual is the distance from 1.
  struct Distance
  {
    double natural_residual(const Vector &x, const Vector &) const
    {
      return std::abs(x[0] - 1);
    }
  };

  struct Search
  {
    double to(const double y)
    {
      return line.search(residual, {{0.}, {0.}}, {{y}, {2 * y}});
    }

    Distance                             residual;
    NewtonOptions                        options;
    detail::LineSearch<Vector, Distance> line{options};
  };
} // namespace

TEST(LineSearch, TakesAWholeStepThatLowersTheResidual)
{
  Search search;
  search.line.begin(1);
  EXPECT_EQ(search.to(1.5), 1);
  EXPECT_DOUBLE_EQ(search.line.found(), 0.5);
}

TEST(LineSearch, CutsAStepAndKnowsTheRefusedPoint)
{
  Search search;
  search.line.begin(1);
  EXPECT_EQ(search.to(6), 0.25); // 6 and 3 are farther from 1 than 0
  EXPECT_DOUBLE_EQ(search.line.found(), 0.5);
  EXPECT_EQ(search.line.end().x, Vector{1.5});
  EXPECT_EQ(search.line.end().gradient, Vector{3});
  EXPECT_EQ(search.line.refused().x, Vector{3});
}

TEST(LineSearch, FindsNothingInTheWrongDirection)
{
  Search search;
  search.line.begin(1);
  EXPECT_EQ(search.to(-1), 0);
  EXPECT_LT(std::abs(search.line.refused().x[0]), 1e-8);
}

TEST(SetHistory, TellsSetsThatRecur)
{
  using detail::Sides;
  const SerialReduction reduction;
  const Sides           a{0, 1}, b{1, 0}, c{-1, 0};
  detail::SetHistory    history(3);
  EXPECT_FALSE(history.contains(a, reduction));
  history.add(a, 5);
  EXPECT_TRUE(history.contains(a, reduction));
  EXPECT_EQ(history.least_of_earlier(a, reduction), infinity); // no other set in between
  history.add(b, 4);
  EXPECT_EQ(history.least_of_earlier(a, reduction), 5);
  history.add(a, 3);
  history.add(c, 2); // the first a is forgotten
  EXPECT_EQ(history.size(), 3u);
  EXPECT_EQ(history.least_of_earlier(a, reduction), 3);
  history.clear();
  EXPECT_FALSE(history.contains(a, reduction));
}
