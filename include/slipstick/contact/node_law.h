// A contact law evaluated at one node with known force, displacement jump and slip bound, for checks and results.
#pragma once

#include <slipstick/contact/result.h>
#include <slipstick/tfeti/constraints.h>

#include <algorithm>
#include <cmath>

namespace slipstick::contact
{
  /// Status of a node. Without friction (bound 0) a closed node slips; an open node slips, too, if its law acts on open
  /// nodes and the bound is reached. @param is_within the traction is strictly inside the bound.
  inline ContactStatus status_of(const bool is_closed, const double slip_bound, const bool is_within)
  {
    if (!is_within && (slip_bound > 0 || is_closed))
      return ContactStatus::slip;
    return is_closed ? ContactStatus::stick : ContactStatus::open;
  }

  /// The inadmissible part of a jump at a bound [mm]: penetration; slip in the direction of the friction force.
  /// @param jump B u - c. @param x multiplier. @param bound of a tangential multiplier. @param noise forces up to this
  /// are rounding.
  inline double inadmissible_jump(const tfeti::RowKind kind,
                                  const double         jump,
                                  const double         x,
                                  const double         bound,
                                  const double         noise)
  {
    if (kind == tfeti::RowKind::tangential && bound <= noise)
      return 0;
    return kind == tfeti::RowKind::tangential && x > 0 ? std::min(jump, 0.) : std::max(jump, 0.);
  }

  /// Difference between the largest friction work that the law admits (the support function of its disc) and the actual
  /// work [N mm].
  /// @param work of the tangential force on the slave body, i.e. its product with the slip: negative.
  inline double missing_friction_work(const double bound, const double work, const double slip)
  {
    return std::abs(bound * std::abs(slip) + work);
  }
} // namespace slipstick::contact
