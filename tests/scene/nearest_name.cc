// The name that a misspelt one most probably means; text to values.
#include <slipstick/base/nearest_name.h>
#include <slipstick/base/text.h>

#include <gtest/gtest.h>

#include <cmath>

using namespace slipstick;

TEST(edit_distance, counts_single_edits)
{
  EXPECT_EQ(edit_distance("box", "box"), 0u);
  EXPECT_EQ(edit_distance("box", "bo"), 1u);
  EXPECT_EQ(edit_distance("box", "boxx"), 1u);
  EXPECT_EQ(edit_distance("box", "bax"), 1u);
  EXPECT_EQ(edit_distance("box", "bxo"), 1u);
  EXPECT_EQ(edit_distance("", "box"), 3u);
  EXPECT_EQ(edit_distance("kitten", "sitting"), 3u);
}

TEST(edit_distance, ignores_case)
{
  EXPECT_EQ(edit_distance("metis", "METIS"), 0u);
}

TEST(nearest_name, is_the_closest)
{
  EXPECT_EQ(nearest_name("Toleranse", {"Algorithm", "Tolerance", "Tolerances"}).value_or(""), "Tolerance");
}

TEST(nearest_name, is_none_when_all_are_far)
{
  EXPECT_FALSE(nearest_name("semismooth newton", {"auto", "smalbe", "pcg"}));
  EXPECT_FALSE(nearest_name("box", {}));
}

TEST(suggest_name, says_so_when_there_are_none)
{
  EXPECT_EQ(suggest_name("box", {}), "there are none");
}

TEST(parse_number, takes_the_whole_text_only)
{
  EXPECT_EQ(parse_number(" -1.5e2 ").value_or(0), -150);
  for (const std::string text : {"", " ", "1 2", "1,5", "x", "1e", "--1", "+-1"})
    EXPECT_FALSE(parse_number(text)) << text;
}

TEST(number_text, reads_back_as_the_same_number)
{
  for (const double value : {0.1, 1e-4, 210000., 1. / 3, -5e-324, 1.7976931348623157e308})
    EXPECT_EQ(parse_number(number_text(value)).value_or(std::nan("")), value);
  EXPECT_EQ(number_text(210000), "210000");
  EXPECT_EQ(number_text(0.3), "0.3");
}

TEST(split_list, trims_and_keeps_empty_parts)
{
  EXPECT_EQ(split_list(" a , b c,"), (std::vector<std::string>{"a", "b c", ""}));
  EXPECT_TRUE(split_list("  ").empty());
}
