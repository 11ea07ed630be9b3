#include <slipstick/base/nearest.h>

namespace slipstick
{
  dealii::Point<3> nearest_on_triangle(const std::array<dealii::Point<3>, 3> &corner, const dealii::Point<3> &x)
  {
    const auto   a = corner[1] - corner[0], b = corner[2] - corner[0], to = x - corner[0];
    const auto   n     = cross_product_3d(a, b);
    const double beta  = cross_product_3d(to, b) * n / n.norm_square(),
                 gamma = cross_product_3d(a, to) * n / n.norm_square();
    if (beta >= 0 && gamma >= 0 && beta + gamma <= 1)
      return corner[0] + beta * a + gamma * b;
    auto best = nearest_on_segment(corner[2], corner[0], x);
    for (const unsigned int i : {0, 1})
      if (const auto y = nearest_on_segment(corner[i], corner[i + 1], x); x.distance(y) < x.distance(best))
        best = y;
    return best;
  }
} // namespace slipstick
