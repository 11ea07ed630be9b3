// Boundaries by condition: "top where abs(x) < 8" is what of the boundary top fulfils it.
#pragma once

#include <slipstick/scene/scene.h>

#include <string>
#include <utility>
#include <vector>

namespace slipstick::scene
{
  /// How a boundary is written in a .prm.
  inline const std::string boundary_format =
    "BODY/BOUNDARY, such as box/left, or a part of it, such as box/top where x < 5";

  /// A boundary's name in two parts.
  struct BoundaryPart
  {
    std::string name;
    std::string condition; // formula of x and y before loading, true where it is not 0; empty: the whole boundary
  };

  /// Takes BoundaryName::boundary apart.
  BoundaryPart part_of_boundary(const std::string &boundary);

  /// "NAME where CONDITION", as BoundaryName::boundary has it.
  std::string to_string(const BoundaryPart &part);

  /// @throws InputError naming @p path for a condition that is no formula of x and y.
  template <int dim>
  void check_condition(const BoundaryPart &part, const std::string &path);

  /// What the scene names as boundaries, with the parameter that does: "Support floor", "Contact joint/Slave".
  template <int dim>
  std::vector<std::pair<std::string, BoundaryName>> used_boundaries(const Scene<dim> &scene);

  /// Does the scene name any boundary with a condition?
  template <int dim>
  bool has_boundary_parts(const Scene<dim> &scene);
} // namespace slipstick::scene
