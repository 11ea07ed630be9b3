// Error of the contact tractions of every pair.
#pragma once

#include <slipstick/tfeti/dual_problem.h>

#include <vector>

namespace slipstick::contact
{
  /// Assesses estimated errors of the multipliers by the L2 norm of the tractions of each pair.
  class TractionError
  {
  public:
    using Vector = tfeti::DistributedVector;

    /// @param tolerance of the solver. @param balance largest multiplier of forces that balance the loads [N].
    /// @param largest_before largest L2 norm of a pair's tractions in earlier steps [sqrt(N MPa)].
    TractionError(const tfeti::DualProblem &dual,
                  const double              tolerance,
                  const double              balance,
                  const double              largest_before);

    /// Whether the error of the tractions of every pair is below a given part of the tractions. (The residual alone
    /// does not tell: it is relative to all loads and gaps.) Collective.
    bool is_small(const Vector &x, const Vector &error) const;

    /// The largest L2 norm of a pair's tractions, in x and in earlier steps [sqrt(N MPa)]. Collective.
    double largest(const Vector &x) const;

  private:
    std::vector<double> squares_of_pairs(const Vector &x, const Vector &error) const;

    const tfeti::DualProblem &dual;
    const double              part;           // admissible error over tractions
    const double              balance;        // [N]
    const double              largest_before; // [sqrt(N MPa)]
  };
} // namespace slipstick::contact
