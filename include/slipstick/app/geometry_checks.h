// Checks for penetrations after loading at places without contact rows.
#pragma once

#include <slipstick/interface/penetration.h>

#include <optional>

namespace slipstick::app
{
  struct GeometryFindings
  {
    /// A declared contact is violated, so that the result is not a solution: place and amount of the penetration, with
    /// a remedy.
    std::optional<std::string> failure;

    /// Texts of warnings with remedy, keyed by subject: obstacles that protrude between nodes, overlapping bodies that
    /// are not joined by a pair, bodies that pass through themselves.
    std::map<std::string, std::string> warnings;
  };

  /// @param largest displacement [mm], the reference length.
  template <int dim>
  GeometryFindings geometry_findings(const scene::Scene<dim>       &scene,
                                     const interface::Penetrations &found,
                                     const double                   largest);
} // namespace slipstick::app
