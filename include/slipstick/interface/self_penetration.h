// Places where a body has passed through itself.
#pragma once

#include <slipstick/interface/deepest_penetration.h>
#include <slipstick/mechanics/surface_facet.h>

#include <optional>
#include <set>
#include <vector>

namespace slipstick::interface
{
  /// The deepest place where the sides of a gap in a body (flanks of a slit, arms of a clip) have passed through each
  /// other. Every part of the surface sees what is opposite it, from its middle along its normal before loading; what
  /// closes the gap is linearised like the rows of contact, so that rotations of the whole body count as nothing.
  /// @param before, now the surface of the body, in the same order, before and after loading
  /// @param exempt numbers of parts that do not look for others, sides of contact pairs
  template <int dim>
  std::optional<Penetration> self_penetration(const std::vector<mechanics::BoundaryPart<dim>> &before,
                                              const std::vector<mechanics::BoundaryPart<dim>> &now,
                                              const std::set<unsigned int>                    &exempt);
} // namespace slipstick::interface
