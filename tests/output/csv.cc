#include <slipstick/output/csv.h>

#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <limits>

using slipstick::output::csv_field;
using slipstick::output::to_text;

TEST(Csv, numbers_read_back_exactly)
{
  using Limits = std::numeric_limits<double>;
  for (const double value : {0.1, 1. / 3, -2.5e-300, 6.02214076e23, std::nextafter(1., 2.), Limits::denorm_min()})
    EXPECT_EQ(std::strtod(to_text(value).c_str(), nullptr), value) << to_text(value);
}

TEST(Csv, numbers_take_no_more_digits_than_needed)
{
  EXPECT_EQ(to_text(0.1), "0.1");
  EXPECT_EQ(to_text(-250), "-250");
}

TEST(Csv, largest_and_longest_numbers_fit)
{
  for (const double value : {-std::numeric_limits<double>::max(), -2.2250738585072014e-308, -1.2345678901234567e-300})
    EXPECT_EQ(std::strtod(to_text(value).c_str(), nullptr), value) << to_text(value);
}

TEST(Csv, numbers_that_are_not_finite_have_names)
{
  EXPECT_EQ(to_text(std::numeric_limits<double>::quiet_NaN()), "nan");
  EXPECT_EQ(to_text(-std::numeric_limits<double>::infinity()), "-inf");
}

TEST(Csv, words_with_commas_and_quotes_are_quoted)
{
  EXPECT_EQ(csv_field("upper yoke"), "upper yoke");
  EXPECT_EQ(csv_field("a,\"b\""), "\"a,\"\"b\"\"\"");
}
