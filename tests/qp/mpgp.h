// MPGP on dense matrices, for the tests.
#pragma once

#include "support.h"

#include <slipstick/qp/mpgp.h>

namespace slipstick::qp::test
{
  inline MpgpOptions with_expansion(const Expansion expansion)
  {
    MpgpOptions options;
    options.expansion = expansion;
    return options;
  }

  /// Runs MPGP until |gP| <= tolerance.
  inline MpgpResult<Vector> run_mpgp(const Matrix      &A,
                                     const Vector      &b,
                                     const Box<Vector> &box,
                                     MpgpStart<Vector>  start,
                                     const double       tolerance,
                                     const MpgpOptions &options,
                                     const double       norm)
  {
    return mpgp([&](const Vector &v, Vector &Av) { Av = A * v; },
                norm,
                b,
                box,
                std::move(start),
                [=](const Vector &, const double gP) { return gP <= tolerance; },
                options,
                SerialReduction());
  }

  /// The three expansions as a test parameter.
  class WithExpansion : public testing::TestWithParam<Expansion>
  {
  protected:
    MpgpOptions options() const
    {
      return with_expansion(GetParam());
    }
  };
} // namespace slipstick::qp::test
