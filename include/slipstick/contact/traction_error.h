// When are the tractions of every contact pair right?
#pragma once

#include <slipstick/tfeti/dual_problem.h>

#include <vector>

namespace slipstick::contact
{
  /// Judges estimated errors of multipliers by the tractions of the pairs, in L2.
  class TractionError
  {
  public:
    using Vector = tfeti::DistributedVector;

    /// @param tolerance of the solver. @param balance the largest multiplier that balances the loads [N].
    /// @param largest_before norm in L2 of a pair's tractions, in the steps before [sqrt(N MPa)].
    TractionError(const tfeti::DualProblem &dual,
                  const double              tolerance,
                  const double              balance,
                  const double              largest_before);

    /// Are the errors of the tractions of every pair below a part of these? What a residual says of them depends on the
    /// scene, for it is relative to all loads and gaps. Collective.
    bool is_small(const Vector &x, const Vector &error) const;

    /// The largest norm of a pair's tractions, those of x and of the steps before [sqrt(N MPa)]. Collective.
    double largest(const Vector &x) const;

  private:
    std::vector<double> squares_of_pairs(const Vector &x, const Vector &error) const;

    const tfeti::DualProblem &dual;
    const double              part;           // of the tractions that errors may be
    const double              balance;        // [N]
    const double              largest_before; // [sqrt(N MPa)]
  };
} // namespace slipstick::contact
