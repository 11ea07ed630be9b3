// slipstick::qp alone, the standard library below it: min 1/2 x'x - b'x within [-1, 1]^3 is b, clipped.
#include <slipstick/qp/mpgp.h>

#include <cstdio>

int main()
{
  using Vector = std::vector<double>;
  const Vector                     b{2, -3, 0.5};
  const slipstick::qp::Box<Vector> box{{-1, -1, -1}, {1, 1, 1}};
  const auto                       result = slipstick::qp::mpgp([](const Vector &x, Vector &Ax) { Ax = x; },
                                          1.,
                                          b,
                                          box,
                                          {Vector(3, 0.)},
                                          [](const Vector &, const double gradient) { return gradient <= 1e-12; },
                                          slipstick::qp::MpgpOptions(),
                                          slipstick::qp::SerialReduction());
  std::printf("%g %g %g\n", result.x[0], result.x[1], result.x[2]);
}
