#include <slipstick/scene/scene.h>

#include <cmath>

namespace slipstick::scene
{
  namespace
  {
    /// Rotation about an axis of any length, z if it is zero (Rodrigues).
    dealii::Tensor<1, 3> turned(const dealii::Tensor<1, 3> &x,
                                const dealii::Tensor<1, 3> &axis,
                                const double                cosine,
                                const double                sine)
    {
      dealii::Tensor<1, 3> a;
      a[2] = 1;
      if (axis.norm() > 0)
        a = axis / axis.norm();
      return cosine * x + sine * cross_product_3d(a, x) + (1 - cosine) * (a * x) * a;
    }
  } // namespace

  template <int dim>
  std::function<void(dealii::Point<dim> &)> Placement<dim>::motion() const
  {
    // multiples of 90 degrees are exact
    const double quarters = rotation / 90;
    const bool   whole    = quarters == std::round(quarters);
    const int    quarter  = whole ? static_cast<int>(std::remainder(quarters, 4)) & 3 : 0;
    const double angle    = rotation * dealii::numbers::PI / 180;
    const double cosine   = whole ? std::array<int, 4>{{1, 0, -1, 0}}[quarter] : std::cos(angle);
    const double sine     = whole ? std::array<int, 4>{{0, 1, 0, -1}}[quarter] : std::sin(angle);
    return [placement = *this, cosine, sine](dealii::Point<dim> &x) {
      if (placement.mirror_x)
        x[0] = -x[0];
      if (placement.mirror_y)
        x[1] = -x[1];
      if constexpr (dim == 3)
        x = dealii::Point<dim>(turned(x, placement.axis, cosine, sine)) + placement.translation;
      else
        x = dealii::Point<dim>(cosine * x[0] - sine * x[1], sine * x[0] + cosine * x[1]) + placement.translation;
    };
  }

  template struct Placement<2>;
  template struct Placement<3>;
} // namespace slipstick::scene
