// State of a contact problem during the solution, shared by the algorithms: the law with its present bounds, the
// present forces, and all counts.
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
    /// All arguments are kept by reference.
    ContactIterate(const tfeti::DualProblem   &dual,
                   const SlipLaw              &law,
                   const scene::SolverOptions &options,
                   const ProgressObserver     &observer,
                   const AccuracyTest         &is_accurate);

  protected:
    using Vector = tfeti::DistributedVector;

    /// Sets the scales of forces and tractions from the loads and the previous load step.
    void set_scales(const Vector &loads, const DualSolution *start);

    /// Sets the present slip bounds [N], one per owned row.
    void set_bounds(std::vector<double> bounds);

    /// Observer of an algorithm: passes its steps on with the counts of the parts already finished, and @p before_step
    /// multiplications, added.
    qp::Observer counted(const unsigned int before_step = 0) const;

    /// Relative change from the present bounds to @p next, over all ranks. Rows where x is strictly inside both bounds
    /// do not count, since x solves the problem with either.
    double change_of_bounds(const std::vector<double> &next, const Vector &x) const;

    /// Callback that ends an algorithm when the present forces are accurate enough; empty if there is no accuracy test.
    qp::Acceptance<Vector> acceptance();

    /// Whether x, projected onto its bounds, is accurate enough. @p g: gradient F x - d + G'a (scaled).
    bool accepts(const Vector &x, const Vector &g);

    /// Completes the solution and moves it out. Rows within rounding of a bound are not free.
    DualSolution finished();

    const tfeti::DualProblem   &dual;
    const SlipLaw              &law;
    const scene::SolverOptions &options;
    const ProgressObserver     &observer;
    const AccuracyTest         &is_accurate;

    Box                   box;      // of the present bounds
    std::optional<Vector> gradient; // at the end of SMALBE-M or the previous step: predicts the first set
    DualSolution          solution;

    double                      size_of_forces = 0; // norm of the smallest forces found that balance the loads [N]
    double                      forces_before  = 0; // DualSolution::largest_forces of the previous steps
    std::optional<TractionTest> tractions;

  private:
    /// Magnitudes of the multipliers of the owned rows; tangential rows in space have that of both components together.
    std::vector<double> sizes(const Vector &x) const;
  };
} // namespace slipstick::contact
