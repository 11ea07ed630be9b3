// Common definitions of the solvers in this layer: status, counts, accuracy, and their template concepts.
//
// Vector      copyable; `begin()`, `end()` are contiguous random access iterators over the entries OWNED BY THIS
//             PROCESS; a copy has the same layout. std::vector<double> is one, so is
//             dealii::LinearAlgebra::distributed::Vector<double> without ghost entries. An operator may replace the
//             storage of the vector it writes, not its layout.
// Reduction   `template <std::size_t n> std::array<double, n> sum(std::array<double, n>) const` and
//             `double min(double) const`, over all processes, with the same result on each of them. Every decision is
//             made from such numbers, so that every process takes the same branch.
// Problem     min 1/2 x'P F P x - x'b, Q x = 0, with
//             `void multiply(const Vector &x, Vector &y) const`       y = F x, F symmetric positive semidefinite,
//             `void project_range(const Vector &x, Vector &y) const`  y = Q x, Q = G'G the orthogonal projector on the
//                                                                     range of G', so |Gx| = |Qx|; P = I - Q,
//             `const Reduction &reduction() const`.
//             All are collective. F is best scaled such that |P F P| is about 1.
//
// Units: the solvers are invariant under x -> s x, b -> t b; nothing compares a length with a force.
#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <functional>

namespace slipstick::qp
{
  /// Result status of a solver.
  enum class Status
  {
    converged,       // the required residuals are reached
    iteration_limit, // an iteration limit of the options was reached
    stagnated,       // residuals are at rounding level, have not decreased for a long time, or are not numbers
    infeasible       // no solution: contradictory constraints, or unbounded from below
  };

  /// Forces below this part of the largest one, and changes below this part of the norm of all, are rounding: such
  /// forces hold nothing and close no node.
  constexpr double force_rounding = 1e-13;

  /// Numbers of operations performed.
  struct Counts
  {
    unsigned int hessian_multiplications     = 0; // with F, or with A in MPGP
    unsigned int preconditioner_applications = 0;
    unsigned int outer_iterations            = 0;
    unsigned int cg_steps                    = 0;
    unsigned int expansion_steps             = 0;
    unsigned int proportioning_steps         = 0;

    Counts &operator+=(const Counts &other)
    {
      hessian_multiplications += other.hessian_multiplications;
      preconditioner_applications += other.preconditioner_applications;
      outer_iterations += other.outer_iterations;
      cg_steps += other.cg_steps;
      expansion_steps += other.expansion_steps;
      proportioning_steps += other.proportioning_steps;
      return *this;
    }
  };

  /// State at the end of an outer step, for logs and convergence histories.
  struct OuterStep
  {
    unsigned int outer                   = 0; // from 1
    unsigned int hessian_multiplications = 0; // so far
    double       projected_gradient      = 0; // |gP| over the reference of the Goal
    double       equality_residual       = 0; // |PFP| |Gx| over the reference of the Goal
    std::size_t  active_lower            = 0; // entries at their lower bound, over all processes
    std::size_t  active_upper            = 0; // entries at their upper bound only
  };

  using Observer = std::function<void(const OuterStep &)>;

  /// Required accuracy: residuals <= tolerance * reference; reference 0 means |b|. If gaps determine the reference,
  /// errors of forces are limited by a scale of their own.
  struct Goal
  {
    Goal(const double tolerance_, const double reference_ = 0, const double forces_ = HUGE_VAL)
      : tolerance(tolerance_)
      , reference(reference_)
      , forces(forces_)
    {}

    double tolerance;
    double reference;
    double forces; // magnitude of the forces that balance the loads, to limit their errors; infinite: unknown
  };

  /// Reduction of a single process.
  struct SerialReduction
  {
    template <std::size_t n>
    std::array<double, n> sum(const std::array<double, n> &values) const
    {
      return values;
    }

    double min(const double value) const
    {
      return value;
    }
  };
} // namespace slipstick::qp
