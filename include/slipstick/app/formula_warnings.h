// Warnings about nodally evaluated formulas (slip bounds, prescribed displacements, gaps) with features between nodes.
#pragma once

#include <slipstick/mechanics/spaces.h>

#include <map>
#include <string>

namespace slipstick::app
{
  /// Texts of warnings with remedy, keyed by subject, at load factor @p t: between the nodes of an edge or face the
  /// formula goes far beyond its values at these nodes. Jumps and slopes do not: they are resolved to an edge.
  /// @param largest displacement [mm], reference for gaps. The same on all ranks. Collective.
  template <int dim>
  std::map<std::string, std::string> formula_warnings(const scene::Scene<dim>      &scene,
                                                      const mesh::Mesh<dim>        &mesh,
                                                      const mechanics::Spaces<dim> &spaces,
                                                      const double                  t,
                                                      const double                  largest);
} // namespace slipstick::app
