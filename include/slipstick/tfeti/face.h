// The dual problem restricted to its free rows (face problem).
#pragma once

#include <slipstick/tfeti/dual_problem.h>

#include <memory>
#include <optional>
#include <vector>

namespace slipstick::tfeti
{
  /// Face problem: the dual problem on its free rows, as required by qp's semismooth Newton method and PCPG. Members
  /// are collective.
  class Face
  {
  public:
    /// @param problem is kept by reference. @param free owned rows. @param ties rows tied to others. @param turns rows
    /// of slipping nodes in space that are treated as turned. Collective.
    Face(const DualProblem           &problem,
         const std::vector<bool>     &free,
         const std::vector<qp::Tie>  &ties  = {},
         const std::vector<qp::Turn> &turns = {});

    void                       multiply(const DistributedVector &x, DistributedVector &y) const; // y = F x / |P F P|
    const MpiReduction        &reduction() const;
    const std::vector<double> &residual_weights() const;
    const std::vector<double> *dependent_compliances() const;

    /// y = Q_f x on the free rows, y = x on the others.
    void project_range(const DistributedVector &x, DistributedVector &y) const;

    /// Changes the free rows of x, and the rows tied to them, by the smallest amount that makes G x = e.
    void balance(DistributedVector &x) const;

    /// Changes the free rows of p by the smallest amount that makes G p = 0, with each tied row equal to its factor
    /// times the row it is tied to.
    void project_kernel(DistributedVector &p) const;

    /// p := 0 on the rows that are neither free nor tied.
    void clear_held(DistributedVector &p) const;

    /// y = G'a on all rows, with the a that minimises |v - G'a| on the free rows.
    void multiplier_shift(const DistributedVector &v, DistributedVector &y) const;

    /// z = M r on the free rows, 0 on the others; a copy without a preconditioner.
    void precondition(const DistributedVector &r, DistributedVector &z) const;

    /// Whether the free rows hold all bodies (G G' on them is nonsingular).
    bool is_regular() const
    {
      return projector != nullptr;
    }

  private:
    using Projection = void (Projector::*)(const DistributedVector &, DistributedVector &) const;
    void                projected(const Projection project, const DistributedVector &x, DistributedVector &y) const;
    void                make_projectors();
    std::vector<double> softened_weights();
    const DistributedVector &turned(const DistributedVector &x, std::optional<DistributedVector> &copy) const;
    void                     add_soft_entries(const DistributedVector &r, DistributedVector &z) const;
    void                     soften(DistributedVector &x) const;

    // Whether a = G x is zero up to rounding. Collective.
    bool is_rounding(const Eigen::VectorXd &a, const DistributedVector &x) const;

    const Projector &balancing() const
    {
      return tied ? *tied : *projector;
    }

    const DualProblem         &problem;
    const RowMetric           &metric;
    std::vector<bool>          free;
    std::vector<qp::Tie>       ties;
    std::vector<qp::Turn>      turns;
    std::vector<double>        stiffness; // by turns: of the row across the force, relative to that without compliance
    std::unique_ptr<Projector> projector; // null if the free rows do not hold the bodies
    std::unique_ptr<Projector> tied;      // of free and tied rows, if some rank has ties
    std::unique_ptr<RowWeights::Inverse> weights;
  };

  /// A projected residual below this part of the residual is rounding, for instance if supports move bodies without
  /// deforming them.
  constexpr double rounding_of_projection = 1e-14;

  /// Norm with the weights of residuals. Collective.
  double weighted_norm(const DualProblem &problem, const DistributedVector &r);

  /// Weighted norm of the part of a residual (such as d - F x over norm()) that multipliers can change; 0 if that part
  /// is only rounding. Collective.
  double residual_norm(const DualProblem &problem, const DistributedVector &r);
} // namespace slipstick::tfeti
