// Numbers and formulas.
#include "tools.h"

#include <cmath>

using slipstick::scene::Field;
using slipstick::test::error_of;
using slipstick::test::expect_parts;

namespace
{
  const dealii::Point<2> point(2, 3);

  double value_of(const std::string &formula, const double t = 1)
  {
    return Field<2>(formula, "test").value(point, t);
  }

  void formula_refused(const std::string &formula, const std::vector<std::string> &parts = {})
  {
    const std::string message = error_of([&] { Field<2>(formula, "Traction a/Traction y"); });
    expect_parts(message, {"Traction a/Traction y", "'" + formula + "'"});
    expect_parts(message, parts);
  }
} // namespace

TEST(field, default_is_zero)
{
  EXPECT_EQ(Field<2>().value(point, 1), 0);
  EXPECT_TRUE(Field<2>().is_constant());
}

TEST(field, plain_numbers_are_constant)
{
  for (const std::string text : {"250", "-2.5e2", "+3", ".5", "1e-3", " 7 "})
    EXPECT_TRUE(Field<2>(text, "test").is_constant()) << text;
  EXPECT_EQ(value_of("-2.5e2"), -250);
  EXPECT_EQ(value_of("+3"), 3);
  EXPECT_EQ(value_of(".5"), 0.5);
}

TEST(field, formula_of_x_y_t_and_pi)
{
  EXPECT_FALSE(Field<2>("x", "test").is_constant());
  EXPECT_DOUBLE_EQ(value_of("x + 10*y + 100*t", 0.5), 82);
  EXPECT_DOUBLE_EQ(value_of("sin(pi/2)*x"), 2);
  EXPECT_DOUBLE_EQ(value_of("x < 1 ? 5 : max(x, y)^2"), 9);
}

TEST(field, copies_share_the_formula_and_stay_independent)
{
  const Field<2> first("x*t", "test");
  const Field<2> second = first;
  EXPECT_EQ(first.value({1, 0}, 2), 2);
  EXPECT_EQ(second.value({3, 0}, 4), 12);
  EXPECT_EQ(first.value({1, 0}, 2), 2);
}

TEST(field, formula_is_kept_as_text)
{
  EXPECT_EQ(Field<2>(" 2*x ", "test").formula(), "2*x");
}

TEST(field, syntax_errors_are_refused)
{
  for (const std::string text : {"x+", "sin(x", "x y", "2 mm", "3e", "x#", "\"a\""})
    formula_refused(text);
  formula_refused("", {"empty"});
}

TEST(field, unknown_names_are_refused_with_the_nearest)
{
  formula_refused("2*z", {"\"z\"", "x, y, t, pi"});
  formula_refused("sni(x)", {"\"sni\"", "nearest: sin"});
}

TEST(field, numbers_that_are_not_finite_are_refused)
{
  for (const std::string text : {"nan", "inf", "-inf", "1e999", "1/0", "log(-1)"})
    formula_refused(text);
}

TEST(field, decimal_comma_is_refused)
{
  formula_refused("1,5", {"comma"});
}

TEST(field, assignment_is_refused)
{
  formula_refused("x=3", {"=="});
  EXPECT_EQ(value_of("x==2"), 1);
  EXPECT_EQ(value_of("x>=2"), 1);
}

TEST(field, poles_are_reported_where_they_are_met)
{
  const Field<2> field("1/x", "Traction a/Traction y");
  EXPECT_DOUBLE_EQ(field.value(point, 1), 0.5);
  expect_parts(error_of([&] { field.value({0, 3}, 1); }), {"Traction a/Traction y", "1/x", "x = 0", "y = 3"});
}

TEST(field, prints_nothing_on_errors)
{
  testing::internal::CaptureStderr();
  testing::internal::CaptureStdout();
  formula_refused("2*z");
  EXPECT_EQ(testing::internal::GetCapturedStderr() + testing::internal::GetCapturedStdout(), "");
}
