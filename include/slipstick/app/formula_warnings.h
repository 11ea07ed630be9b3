// Warnings about nodally evaluated formulas (slip bounds, prescribed displacements, gaps) with features between nodes.
#pragma once

#include <slipstick/mechanics/spaces.h>

#include <map>
#include <string>

namespace slipstick::app
{
  /// Texts of warnings with remedy, keyed by subject, at load factor @p t, for formulas whose values between the nodes
  /// of an edge or face are far outside the range of their nodal values. Jumps and slopes cause no warning: they are
  /// resolved to an edge.
  /// @param largest displacement [mm], reference for gaps. The same on all ranks. Collective.
  template <int dim>
  std::map<std::string, std::string> formula_warnings(const scene::Scene<dim>      &scene,
                                                      const mesh::Mesh<dim>        &mesh,
                                                      const mechanics::Spaces<dim> &spaces,
                                                      const double                  t,
                                                      const double                  largest);
} // namespace slipstick::app
