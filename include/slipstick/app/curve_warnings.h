// Warnings about arcs that a mesh replaces by polygons, and the effect on contact.
#pragma once

#include <slipstick/contact/result.h>
#include <slipstick/mechanics/spaces.h>
#include <slipstick/tfeti/constraints.h>

#include <map>

namespace slipstick::app
{
  /// Warnings with remedy, keyed by subject, for pairs of bodies whose edges or faces neglect a sagitta
  /// (EdgeCurve::neglected_sagitta) that is not small compared with the indentation or, for open contact, with the gap.
  /// Collective.
  /// @param nodes contact nodes of this rank; the first ones correspond to the points of Constraints.
  template <int dim>
  std::map<std::string, std::string> curve_warnings(const scene::Scene<dim>                 &scene,
                                                    const mesh::Mesh<dim>                   &mesh,
                                                    const mechanics::Spaces<dim>            &spaces,
                                                    const std::vector<tfeti::ContactPoint>  &points,
                                                    const std::vector<contact::ContactNode> &nodes);
} // namespace slipstick::app
