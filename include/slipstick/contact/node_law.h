// A contact law evaluated at one node whose forces, motion and slip bound are known, for checks and results.
#pragma once

#include <slipstick/contact/result.h>
#include <slipstick/tfeti/constraints.h>

#include <algorithm>
#include <cmath>

namespace slipstick::contact
{
  /// Without friction (a bound of 0) a node that touches is free to slide. A bound that acts on open nodes, too, makes
  /// them slip as well. @param is_within strictly inside the bound.
  inline ContactStatus status_of(const bool is_closed, const double slip_bound, const bool is_within)
  {
    if (!is_within && (slip_bound > 0 || is_closed))
      return ContactStatus::slip;
    return is_closed ? ContactStatus::stick : ContactStatus::open;
  }

  /// The part of a jump that is not allowed at a bound [mm]: penetration; slip in the direction in which friction
  /// pushes.
  /// @param jump B u - c, @param x multiplier, @param bound of it, if tangential, @param noise forces that are
  /// rounding.
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

  /// Friction work missing from the maximum that the law admits (the support function of its disc) [N mm].
  /// @param work of the tangential force on the slave body, its product with the slip: negative.
  inline double missing_friction_work(const double bound, const double work, const double slip)
  {
    return std::abs(bound * std::abs(slip) + work);
  }
} // namespace slipstick::contact
