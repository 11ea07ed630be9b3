// Slip bounds of the contact laws, and the admissible forces.
#pragma once

#include <slipstick/qp/force_set.h>
#include <slipstick/scene/scene.h>
#include <slipstick/tfeti/dual_problem.h>

namespace slipstick::contact
{
  using Box = qp::Box<tfeti::DistributedVector>;

  /// Bounds of the multipliers: normal >= 0, |tangential| <= slip bound, equality rows unbounded [N].
  Box multiplier_box(const tfeti::DualProblem &dual, const std::vector<double> &slip_bound);

  /// A slipping node whose slip bound follows its normal force.
  struct SlippingNode
  {
    qp::PressureBound rows;
    double            bound; // [N], > 0
    double            slope; // its derivative with respect to the normal force [-], > 0
  };

  /// The contact laws of a scene on the rows of a dual problem: the admissible forces at every contact node.
  class SlipLaw
  {
  public:
    /// Bounds that do not depend on the solution, one per owned row [N].
    explicit SlipLaw(std::vector<double> fixed_bounds);

    /// The laws of the scene at load factor t. Collective.
    /// @throws InputError on all ranks when a slip bound or friction coefficient is negative or not a number.
    template <int dim>
    SlipLaw(const scene::Scene<dim> &scene, const tfeti::DualProblem &dual, const double t);

    /// The same law with @p factor times the friction at every node.
    SlipLaw scaled(const double factor) const;

    /// Whether the bounds depend on the normal forces (on any rank).
    bool depends_on_pressure() const
    {
      return follows_pressure;
    }

    /// Slip bounds for the multipliers x [N], one per owned row.
    std::vector<double> bounds(const tfeti::DistributedVector &x) const;

    /// The bounds that depend on the normal forces, for a solver that updates them itself; entries: owned rows.
    const std::vector<qp::PressureBound> &pressure_bounds() const
    {
      return rows;
    }

    /// The nodes that slip under the multipliers x and may change their normal force, where the slip bound follows it.
    /// @param free owned rows: the multiplier is strictly inside its bounds
    std::vector<SlippingNode> slipping_nodes(const tfeti::DistributedVector &x, const std::vector<bool> &free) const;

    /// Discs with radii fixed at @p bounds, for a solver.
    /// @param all true: all nodes in space with friction; false: those whose bound does not depend on a normal force
    /// (for a solver that follows the normal forces).
    std::vector<qp::PressureBound> fixed_discs(const std::vector<double> &bounds, const bool all) const;

    /// Whether there are discs (on any rank).
    bool has_discs() const
    {
      return is_in_space;
    }

    /// The set of multipliers that are admissible for some pressure.
    qp::ForceSet<tfeti::DistributedVector> admissible(const tfeti::DualProblem &dual) const;

  private:
    std::vector<double>            fixed; // [N], of every owned row; 0 where the bound follows the pressure
    std::vector<qp::PressureBound> rows;  // owned rows whose bound follows the pressure
    std::vector<qp::PressureBound> discs; // owned rows in space whose bound does not
    bool                           follows_pressure = false;
    bool                           is_in_space      = false;
  };
} // namespace slipstick::contact
