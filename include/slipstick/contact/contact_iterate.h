// A contact problem on its way to the solution, which the algorithms share: the law with its present bounds, the present
// forces, and all that is counted.
#pragma once

#include <slipstick/contact/dual_solution.h>
#include <slipstick/contact/slip_law.h>
#include <slipstick/contact/traction_error.h>
#include <slipstick/qp/semismooth_newton.h>

#include <optional>
#include <vector>

namespace slipstick::contact
{
  /// All functions are collective. Forces are multipliers of the owned rows [N].
  class ContactIterate
  {
  public:
    /// All arguments are referred to.
    ContactIterate(const tfeti::DualProblem   &dual,
                   const SlipLaw              &law,
                   const scene::SolverOptions &options,
                   const ProgressObserver     &observer,
                   const AccuracyTest         &is_accurate);

  protected:
    using Vector = tfeti::DistributedVector;

    /// Scales of forces and tractions, from the loads and the load step before.
    void set_scales(const Vector &loads, const DualSolution *start);

    /// Slip bounds of all owned rows [N] become the present ones.
    void set_bounds(std::vector<double> bounds);

    /// Counts of finished parts are added to what the observer is told of a part under way.
    qp::Observer counted(const unsigned int before_step = 0) const;

    /// Relative change from the present bounds to those of x, over all ranks, of rows that feel it: x strictly inside both
    /// solves with either.
    double change_of_bounds(const std::vector<double> &next, const Vector &x) const;

    /// Ends an algorithm where the present forces are accurate enough, if that is asked for.
    qp::Acceptance<Vector> acceptance();

    /// Asks whether x, moved to its bounds, is accurate enough. @p g: gradient F x - d + G'a (scaled).
    bool accepts(const Vector &x, const Vector &g);

    /// Fills which inequality rows are at a bound, or as near as rounding.
    DualSolution finished();

    const tfeti::DualProblem   &dual;
    const SlipLaw              &law;
    const scene::SolverOptions &options;
    const ProgressObserver     &observer;
    const AccuracyTest         &is_accurate;

    Box                   box;      // of the present bounds
    std::optional<Vector> gradient; // that tells Newton's method its first set: where SMALBE-M or the step before ended
    DualSolution          solution;

    double                      size_of_forces = 0; // of the least forces found that balance the loads [N]
    double                      forces_before  = 0; // as DualSolution::largest_forces
    std::optional<TractionTest> tractions;

  private:
    /// Of every owned row the size of its multiplier; in space tangential ones have that of both.
    std::vector<double> sizes(const Vector &x) const;
  };
} // namespace slipstick::contact
