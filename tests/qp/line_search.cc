// The line search of the semismooth Newton method for a known residual, its whole steps and its history of sets.
#include "support.h"

#include <slipstick/qp/line_search.h>
#include <slipstick/qp/set_history.h>
#include <slipstick/qp/watchdog.h>

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

TEST(LineSearch, ComparesWithTheResidualOfThePresentPoint)
{
  Search search;
  search.line.begin(0.5);
  search.line.move_to(3);     // a whole step that was taken although it raised the residual
  EXPECT_EQ(search.to(3), 1); // a residual of 2, less than 3
  search.line.move_to(1);
  EXPECT_LT(search.to(3), 1); // the 3 is forgotten
  EXPECT_EQ(search.line.least(), 0.5);
  search.line.rescale(4);
  EXPECT_EQ(search.line.present(), 4);
  EXPECT_EQ(search.line.least(), 2);
  EXPECT_EQ(search.to(3), 1);
}

namespace
{
  /// A line search at 0, where the residual is 1, and whole steps from there.
  struct WholeSteps : Search
  {
    WholeSteps()
    {
      options.largest_rise   = 100;
      options.least_progress = 0.5;
      line.begin(1);
    }

    /// A step to @p y that is cut to almost nothing. @return whether whole steps begin.
    bool cut(const double y)
    {
      const double t = to(y);
      if (!watchdog.may_begin(line))
        return false;
      watchdog.begin({{{0.}, {0.}, {0.}}, {{y}, {2 * y}, {y}}, {3.}, line, t});
      line.move_to(line.whole());
      return true;
    }

    bool goes_on_to(const double y)
    {
      to(y);
      const bool result = watchdog.continues(line);
      if (result)
        line.move_to(line.whole());
      return result;
    }

    detail::Watchdog<Vector, Distance> watchdog{options};
  };
} // namespace

TEST(Watchdog, WholeStepsEndBelowTheResidualWhereTheyBegan)
{
  WholeSteps steps;
  ASSERT_TRUE(steps.cut(-49)); // residual 50
  EXPECT_TRUE(steps.watchdog.is_watching());
  EXPECT_TRUE(steps.goes_on_to(-19)); // 20, less than half of it
  EXPECT_TRUE(steps.watchdog.is_watching());
  EXPECT_TRUE(steps.goes_on_to(1.9)); // 0.9, below the 1 where they began
  EXPECT_FALSE(steps.watchdog.is_watching());
}

TEST(Watchdog, StepsWithoutProgressLeadBackAndTheNextOnesWait)
{
  WholeSteps steps;
  for (const unsigned int n_waiting : {0, 1, 3, 7})
    {
      for (unsigned int k = 0; k < n_waiting; ++k)
        EXPECT_FALSE(steps.cut(-49)) << n_waiting;
      ASSERT_TRUE(steps.cut(-49)) << n_waiting;
      EXPECT_FALSE(steps.goes_on_to(-29)); // 30 is more than half of 50
      const auto start = steps.watchdog.give_up();
      EXPECT_FALSE(steps.watchdog.is_watching());
      EXPECT_EQ(start.from.x, Vector{0.});
      EXPECT_EQ(start.to.x, Vector{-49});
      EXPECT_EQ(start.predicted_from, Vector{3.});
      EXPECT_EQ(start.line.present(), 1);
      steps.line = start.line;
    }
}

TEST(Watchdog, AStepThatRaisesTheResidualTooMuchIsNotTaken)
{
  WholeSteps steps;
  EXPECT_FALSE(steps.cut(-100)); // 101 times the residual
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
