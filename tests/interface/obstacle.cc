// Distances to rigid obstacles.
#include "torn.h"

#include <slipstick/base/log.h>
#include <slipstick/interface/obstacle.h>

using namespace slipstick;

namespace
{
  /// Gap [mm] and normal of the node at x [mm] above waves whose height is a part of their length, on a body of 5 mm;
  /// all lengths of the scene in units of @p unit mm.
  template <int dim>
  interface::ObstacleContact<dim> contact_with_waves(const dealii::Point<dim> &x, const double unit) {
    scene::Obstacle<dim> obstacle;
    obstacle.shape         = scene::ObstacleShape::function;
    obstacle.extent        = 5 / unit;
    const std::string size = format("%.17g", unit);
    obstacle.height =
      scene::Field<dim>("0.2*sin(x*" + size + ")" + (dim == 3 ? "*cos(z*" + size + ")" : "") + "/" + size, "Height");
    auto contact = interface::contact_with(obstacle, dealii::Point<dim>(x / unit), 0.);
    contact.gap *= unit;
    return contact;
  }

  template <int dim>
  void expect_no_difference(const dealii::Point<dim> &x)
  {
    const auto in_mm = contact_with_waves(x, 1.), in_m = contact_with_waves(x, 1000.);
    EXPECT_NEAR(in_m.gap, in_mm.gap, 1e-9);
    EXPECT_LT((in_m.normal - in_mm.normal).norm(), 1e-8);
  }
} // namespace

TEST(Obstacle, height_function_is_as_exact_in_metres_as_in_millimetres)
{
  for (const double x : {0., 0.3, 2., 4.9})
    for (const double gap : {-0.01, 0., 0.3})
      {
        expect_no_difference(dealii::Point<2>(x, 0.2 * std::sin(x) + gap));
        expect_no_difference(dealii::Point<3>(x, 0.2 * std::sin(x) * std::cos(1.) + gap, 1.));
      }
}
