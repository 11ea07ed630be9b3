#include "torn.h"

#include <slipstick/base/exceptions.h>
#include <slipstick/contact/friction.h>

using namespace slipstick;
using namespace slipstick::test;
using tfeti::RowKind;

namespace
{
  const std::vector<Cut> cuts = {whole(), blocks(2), metis(5)};

  constexpr double infinity = std::numeric_limits<double>::infinity();
} // namespace

TEST(SlipBounds, are_the_formula_times_the_tributary_area)
{
  for (const unsigned int degree : {1, 2})
    for (const Cut &how : cuts)
      {
        Scene scene               = box_on_circle(8, "100 + 10*x + y", degree);
        scene.bodies[0].thickness = 3;
        const Torn torn(cut(scene, how));
        const auto dual   = torn.dual();
        const auto bounds = contact::slip_bounds(scene, *dual, 1.);
        for (const auto &point : torn.constraints.contact_points)
          EXPECT_NEAR(bounds[point.tangential_row], (100 + 10 * point.position[0]) * point.area, 1e-10);
      }
}

TEST(SlipBounds, are_zero_for_rows_that_are_not_tangential)
{
  for (const Cut &how : cuts)
    {
      const Torn torn(cut(box_on_circle(8, "100"), how));
      const auto bounds = contact::slip_bounds(torn.scene, *torn.dual(), 1.);
      ASSERT_EQ(bounds.size(), torn.constraints.kind.size());
      for (unsigned int r = 0; r < bounds.size(); ++r)
        EXPECT_EQ(bounds[r] == 0, torn.constraints.kind[r] != RowKind::tangential);
    }
}

TEST(SlipBounds, follow_the_load_factor)
{
  const Torn torn(cut(box_on_circle(8, "100*t"), blocks(2)));
  const auto dual = torn.dual();
  const auto one = contact::slip_bounds(torn.scene, *dual, 1.), half = contact::slip_bounds(torn.scene, *dual, 0.5);
  for (unsigned int r = 0; r < one.size(); ++r)
    EXPECT_NEAR(half[r], one[r] / 2, 1e-12);
}

TEST(SlipBounds, negative_ones_are_refused_on_all_ranks)
{
  // negative only at the right end, which a single rank owns
  for (const Cut &how : cuts)
    {
      const Torn        torn(cut(box_on_circle(8, "9.9-x"), how));
      const auto        dual = torn.dual();
      const std::string text = message_on_all_ranks<InputError>([&] { contact::slip_bounds(torn.scene, *dual, 1.); });
      for (const std::string part : {"touches", "Slip bound", "-0.1", "(10, 0)", "remedy: "})
        EXPECT_NE(text.find(part), std::string::npos) << text;
    }
}

TEST(MultiplierBox, follows_the_kind_of_the_rows)
{
  for (const Cut &how : cuts)
    {
      const Torn          torn(cut(box_on_circle(8, "100"), how));
      const auto          dual = torn.dual();
      std::vector<double> bounds;
      for (unsigned int r = 0; r < torn.constraints.kind.size(); ++r)
        bounds.push_back(r + 1.);
      const auto box = contact::multiplier_box(*dual, bounds);
      for (unsigned int r = 0; r < bounds.size(); ++r)
        {
          const double lower = box.lower.local_element(r), upper = box.upper.local_element(r);
          switch (torn.constraints.kind[r])
            {
              case RowKind::tangential:
                EXPECT_EQ(lower, -(r + 1.));
                EXPECT_EQ(upper, r + 1.);
                break;
              case RowKind::normal:
                EXPECT_EQ(lower, 0);
                EXPECT_EQ(upper, infinity);
                break;
              default:
                EXPECT_EQ(lower, -infinity);
                EXPECT_EQ(upper, infinity);
            }
        }
    }
}
