// Penetrations after loading that the contact rows do not see.
#pragma once

#include <slipstick/interface/penetration.h>

#include <optional>

namespace slipstick::app
{
  struct GeometryFindings
  {
    /// A declared contact is violated, so that the answer is not a solution: what penetrates where, with the remedy.
    std::optional<std::string> failure;

    /// Texts of warnings with remedy, keyed by subject: obstacles between nodes, bodies that no pair joins.
    std::map<std::string, std::string> warnings;
  };

  /// @param largest displacement [mm], to compare with.
  template <int dim>
  GeometryFindings geometry_findings(const scene::Scene<dim>       &scene,
                                     const interface::Penetrations &found,
                                     const double                   largest);
} // namespace slipstick::app
