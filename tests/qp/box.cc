// Bounds: projection, parts of the gradient, longest step, active entries, Farkas certificates.
#include "support.h"

using namespace slipstick::qp;
using namespace slipstick::qp::test;

namespace
{
  const Box<Vector>     box{{-1, -1, -1, 2, -infinity, 0, -infinity}, {1, 1, 1, 2, 3, infinity, infinity}};
  const SerialReduction serial;
} // namespace

TEST(Box, projection_respects_finite_infinite_and_equal_bounds)
{
  Vector x{-5, 0.5, 5, 7, 9, -9, 1e30};
  project(box, x);
  EXPECT_EQ(x, (Vector{-1, 0.5, 1, 2, 3, 0, 1e30}));
}

TEST(Box, free_and_chopped_gradient_add_up_to_the_projected_gradient)
{
  const Vector x{-1, 0.5, 1, 2, 3, 0, 1e30};
  for (const double g : {-2.0, 0.0, 2.0})
    for (std::size_t i = 0; i < x.size(); ++i)
      EXPECT_EQ(projected_gradient(x[i], g, box.lower[i], box.upper[i]),
                free_gradient(x[i], g, box.lower[i], box.upper[i]) +
                  chopped_gradient(x[i], g, box.lower[i], box.upper[i]));
}

TEST(Box, chopped_gradient_only_points_inwards)
{
  EXPECT_EQ(chopped_gradient(-1, -3, -1, 1), -3);
  EXPECT_EQ(chopped_gradient(-1, 3, -1, 1), 0);
  EXPECT_EQ(chopped_gradient(1, 3, -1, 1), 3);
  EXPECT_EQ(chopped_gradient(1, -3, -1, 1), 0);
  EXPECT_EQ(chopped_gradient(0, 3, -1, 1), 0);
}

TEST(Box, fixed_entry_has_no_projected_gradient)
{
  for (const double g : {-3.0, 3.0})
    {
      EXPECT_EQ(free_gradient(2, g, 2, 2), 0);
      EXPECT_EQ(projected_gradient(2, g, 2, 2), 0);
    }
}

TEST(Box, reduced_free_gradient_keeps_the_step_within_both_bounds)
{
  const double step = 0.5;
  for (const double x : {-0.9, 0.0, 0.9})
    for (const double phi : {-10.0, -0.1, 0.0, 0.1, 10.0})
      {
        const double reduced = reduced_free_gradient(x, phi, -1, 1, step);
        EXPECT_LE(std::abs(x - step * reduced), 1 + 1e-15);
        EXPECT_LE(std::abs(reduced), std::abs(phi));
        EXPECT_GE(reduced * phi, 0);
      }
  EXPECT_EQ(reduced_free_gradient(0, -10, 0, infinity, step), -10);
}

TEST(Box, longest_step_ends_exactly_on_the_first_bound)
{
  Vector       x{-0.5, 0.5, 0.1, 2, 0, 1, 0};
  const Vector p{0.3, -0.7, 0.2, 0, 0, 0, -5};
  const double a = longest_step(box, x, p, serial);
  EXPECT_DOUBLE_EQ(a, 0.5 / 0.7);
  step_within(box, a, p, x);
  EXPECT_EQ(x[1], 1.0);
  EXPECT_TRUE(is_within(box, x));
  EXPECT_DOUBLE_EQ(x[6], 5 * a);
}

TEST(Box, longest_step_is_infinite_where_nothing_stops_it)
{
  EXPECT_EQ(longest_step(box, Vector{0, 0, 0, 2, 0, 1, 0}, Vector{0, 0, 0, 0, 1, -1, 1}, serial), infinity);
}

TEST(Box, fixed_entries_count_once_as_active)
{
  const auto active = own_active(box, Vector{-1, 1, 0, 2, 3, 0, 0});
  EXPECT_EQ(active.lower, 3u);
  EXPECT_EQ(active.upper, 2u);
}

TEST(Box, farkas_certificate_is_accepted_only_if_it_proves)
{
  const Box<Vector> unit{{-1, -1}, {1, 1}};
  const Vector      r{1, 1};
  EXPECT_TRUE(is_farkas_certificate(unit, r, Vector{1.5, 0.6}, 1e3, 1e-9, serial));
  EXPECT_FALSE(is_farkas_certificate(unit, r, Vector{1.5, 0.4}, 1e3, 1e-9, serial));
  EXPECT_FALSE(is_farkas_certificate(unit, r, Vector{1.5, 0.5 + 1e-12}, 1e3, 1e-9, serial));
}

TEST(Box, farkas_certificate_must_vanish_on_unbounded_entries)
{
  const Box<Vector> half{{-1, 0}, {1, infinity}};
  const Vector      x_e{3, 0};
  EXPECT_TRUE(is_farkas_certificate(half, Vector{1, 0}, x_e, 1e3, 1e-9, serial));
  EXPECT_TRUE(is_farkas_certificate(half, Vector{1, -1}, x_e, 1e3, 1e-9, serial));
  EXPECT_TRUE(is_farkas_certificate(half, Vector{1, 1e-5}, x_e, 1e3, 1e-9, serial));
  EXPECT_FALSE(is_farkas_certificate(half, Vector{1, 0.1}, x_e, 1e3, 1e-9, serial));
}
