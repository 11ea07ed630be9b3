// Slip bounds that depend on the pressure as a fixed point: problems with given bounds, one after the other, with Newton's
// method tried in between. What SMALBE-M alone does, and what Newton's method falls back to.
#pragma once

#include <slipstick/contact/contact_algorithms.h>

#include <vector>

namespace slipstick::contact
{
  /// All functions are collective.
  class BoundIteration : protected ContactAlgorithms
  {
  public:
    /// All arguments are referred to.
    BoundIteration(const tfeti::DualProblem     &dual,
                   const SlipLaw                &law,
                   const scene::SolverOptions   &options,
                   const scene::FrictionOptions &friction,
                   const ProgressObserver       &observer,
                   const AccuracyTest           &is_accurate);

  protected:
    /// Where SMALBE-M ends without convergence its set may be near the right one, on which Newton's method solves.
    void follow_bounds_to_the_end(const Vector &from, const Vector &feasible);

    const scene::FrictionOptions &friction;
    unsigned long long            multiplications_beside = 0; // of other problems, which do not count against the limit

  private:
    /// Fixed point of the bounds.
    void follow_bounds(Vector from);

    /// The problem with its present bounds, from a point that balances the loads within them: by SMALBE-M, or, where
    /// that is not what was asked for, by Newton's method first.
    void solve_within_bounds(const Vector &from, const double accuracy, const bool may_end_early);

    /// Where Newton's method ended far from the solution, SMALBE-M comes nearer and nearer to it until that converges from
    /// there.
    bool newton_from_smalbe(const Vector &from);

    /// Newton's method is tried again after 1, 2, 4, 8, ... rounds: a part of the cost of these, whatever they are.
    bool is_due(const unsigned int rounds) const;

    /// (1 - part) times the present bounds, and part times the next ones.
    std::vector<double> blend(const std::vector<double> &next, const double part) const;

    /// Takes the part of the way to the next bounds that admits an equilibrium; `from` is moved to the nearest one.
    bool move_bounds(const std::vector<double> &next, double part, Vector &from);
  };
} // namespace slipstick::contact
