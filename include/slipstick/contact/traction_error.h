// Error of the contact tractions of every pair.
#pragma once

#include <slipstick/contact/result.h>
#include <slipstick/tfeti/dual_problem.h>

#include <vector>

namespace slipstick::contact
{
  /// Estimates of the errors of tractions relative to the exact solution of the discrete problem.
  class TractionErrors
  {
  public:
    using Vector = tfeti::DistributedVector;

    /// Collective. @param x multipliers of the owned rows [N]. @param error their estimated error [N].
    TractionErrors(const tfeti::DualProblem &dual, const Vector &x, const Vector &error);

    /// For each pair the L2 norms of the errors of pressures and of tangential tractions over those of these tractions
    /// themselves. The latter are taken as at least 1 % of the norm of both together, 1e-6 of the largest such norm of
    /// any pair, and @p least [sqrt(N MPa)].
    std::vector<PairTractions> relative(const double least) const;

    /// The largest L2 norm of a pair's tractions [sqrt(N MPa)].
    double largest_norm() const;

  private:
    std::vector<PairTractions> norms, errors; // [sqrt(N MPa)], the same on all ranks
  };

  /// Decides whether the tractions of every pair are accurate enough. (The residual alone does not show this: it is
  /// relative to all loads and gaps.)
  class TractionTest
  {
  public:
    using Vector = tfeti::DistributedVector;

    /// @param tolerance of the solver. @param balance largest multiplier of forces that balance the loads [N].
    /// @param largest_before largest L2 norm of a pair's tractions in earlier steps [sqrt(N MPa)].
    TractionTest(const tfeti::DualProblem &dual,
                 const double              tolerance,
                 const double              balance,
                 const double              largest_before);

    /// Whether any process has nodes of pairs, bonded ones included.
    bool has_pairs() const
    {
      return largest_area > 0;
    }

    /// Whether the errors are below a given fraction of the tractions. Collective. @p error: estimated error of x.
    bool accepts(const Vector &x, const Vector &error) const;

    /// The largest L2 norm of a pair's tractions, in x and in earlier steps [sqrt(N MPa)]. Collective.
    double largest(const Vector &x) const;

  private:
    const tfeti::DualProblem &dual;
    const double              part;           // admissible error over tractions
    const double              balance;        // [N]
    const double              largest_area;   // of a node [mm^2]
    const double              largest_before; // [sqrt(N MPa)]
  };
} // namespace slipstick::contact
