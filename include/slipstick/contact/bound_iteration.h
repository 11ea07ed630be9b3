// Fixed-point iteration on slip bounds that depend on the pressure: solves problems with given bounds one after the
// other and tries Newton's method in between. Used with SMALBE-M, and as the fallback of Newton's method.
#pragma once

#include <slipstick/contact/contact_algorithms.h>

#include <vector>

namespace slipstick::contact
{
  /// All functions are collective.
  class BoundIteration : protected ContactAlgorithms
  {
  public:
    /// All arguments are kept by reference.
    BoundIteration(const tfeti::DualProblem     &dual,
                   const SlipLaw                &law,
                   const scene::SolverOptions   &options,
                   const scene::FrictionOptions &friction,
                   const ProgressObserver       &observer,
                   const AccuracyTest           &is_accurate);

  protected:
    /// Runs follow_bounds(). If that stagnates or reaches its iteration limit, tries Newton's method from where it
    /// ended, since the active set there may be almost right.
    void follow_bounds_to_the_end(const Vector &from, const Vector &feasible);

    const scene::FrictionOptions &friction;
    unsigned long long            multiplications_beside = 0; // of auxiliary problems; they raise the limit

  private:
    /// Fixed-point iteration on the bounds; with bounds that do not depend on the pressure a single solve.
    void follow_bounds(Vector from);

    /// Solves the problem with its present bounds, starting from a point that balances the loads within them. If
    /// Newton's method is the selected algorithm and bounds depend on the pressure, it is tried first; otherwise, or if
    /// it fails, SMALBE-M.
    void solve_within_bounds(const Vector &from, const double accuracy, const bool may_end_early);

    /// If Newton's method ended far from the solution, SMALBE-M solves to smaller and smaller residuals until Newton's
    /// method converges from there. @return convergence.
    bool newton_from_smalbe(const Vector &from);

    /// Whether Newton's method is tried again: after 1, 2, 4, 8, ... rounds, so that its cost remains a fraction of
    /// that of the rounds.
    bool is_due(const unsigned int rounds) const;

    /// (1 - part) times the present bounds, and part times the next ones.
    std::vector<double> blend(const std::vector<double> &next, const double part) const;

    /// Moves the bounds towards the next ones by @p part of the way, or less if that admits no equilibrium; `from` is
    /// moved to the nearest point that balances the loads. @return false if no such step was found.
    bool move_bounds(const std::vector<double> &next, double part, Vector &from);
  };
} // namespace slipstick::contact
