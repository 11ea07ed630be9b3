// Slip bounds of the contact laws, and the forces that a law admits.
#pragma once

#include <slipstick/qp/friction_cones.h>
#include <slipstick/qp/pressure_bounds.h>
#include <slipstick/scene/scene.h>
#include <slipstick/tfeti/dual_problem.h>

namespace slipstick::contact
{
  using Box = qp::Box<tfeti::DistributedVector>;

  /// Bounds of the multipliers: normal >= 0, |tangential| <= slip bound, equality rows free [N].
  Box multiplier_box(const tfeti::DualProblem &dual, const std::vector<double> &slip_bound);

  /// Slip bound of every owned row [N], 0 for rows that are not tangential. Tresca: bound times tributary area, on the
  /// whole boundary or where the pair is closed; Coulomb: friction coefficient times normal force.
  class SlipLaw
  {
  public:
    /// Bounds that do not depend on the solution, one an owned row [N].
    explicit SlipLaw(std::vector<double> fixed_bounds);

    /// The laws of the scene at load factor t. Collective.
    /// @throws InputError on all ranks when a slip bound or friction coefficient is negative or no number.
    template <int dim>
    SlipLaw(const scene::Scene<dim> &scene, const tfeti::DualProblem &dual, const double t);

    /// Do the bounds depend on the normal forces (on any rank)?
    bool depends_on_pressure() const
    {
      return follows_pressure;
    }

    /// Slip bounds for the multipliers x [N], one an owned row.
    std::vector<double> bounds(const tfeti::DistributedVector &x) const;

    /// The bounds that depend on the normal forces, for a solver that follows them itself; entries: owned rows.
    std::vector<qp::PressureBound> pressure_bounds() const;

    /// All multipliers that some pressure admits: cones for Coulomb friction, bounds for the others.
    qp::FrictionCones<tfeti::DistributedVector> admissible(const tfeti::DualProblem &dual) const;

  private:
    struct Row
    {
      unsigned int tangential, normal; // owned rows
      double       coefficient;        // Coulomb
      bool         is_coulomb;         // else: the fixed bound acts while the normal row is pressed
    };

    std::vector<double> fixed;
    std::vector<Row>    rows; // whose bound depends on the pressure
    bool                follows_pressure = false;
  };
} // namespace slipstick::contact
