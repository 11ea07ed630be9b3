// Places inside each other after loading that the rows of contact do not watch.
#pragma once

#include <slipstick/interface/penetration.h>

#include <optional>

namespace slipstick::app
{
  struct GeometryFindings
  {
    /// A declared contact is not kept, so that the answer is none: what is where, with the remedy.
    std::optional<std::string> failure;

    /// Texts of warnings with remedy, by what they are about: obstacles between nodes, bodies that no pair joins.
    std::map<std::string, std::string> warnings;
  };

  /// @param largest displacement [mm], to compare with.
  GeometryFindings judge(const scene::Scene<2> &scene, const interface::Penetrations &found, const double largest);
} // namespace slipstick::app
