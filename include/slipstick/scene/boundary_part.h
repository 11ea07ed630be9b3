// Boundaries defined by a condition: "top where abs(x) < 8" is the part of boundary top that satisfies it.
#pragma once

#include <slipstick/scene/scene.h>

#include <string>
#include <utility>
#include <vector>

namespace slipstick::scene
{
  /// Syntax of a boundary in a .prm, for messages.
  inline const std::string boundary_format =
    "BODY/BOUNDARY, such as box/left, or a part of it, such as box/top where x < 5";

  /// A boundary's name in two parts.
  struct BoundaryPart
  {
    std::string name;
    std::string condition; // formula of x and y before loading, true where it is not 0; empty: the whole boundary
  };

  /// Splits BoundaryName::boundary.
  BoundaryPart part_of_boundary(const std::string &boundary);

  /// "NAME where CONDITION", the inverse of part_of_boundary().
  std::string to_string(const BoundaryPart &part);

  /// @throws InputError naming @p path for a condition that is not a formula of x and y.
  template <int dim>
  void check_condition(const BoundaryPart &part, const std::string &path);

  /// All boundaries named in the scene, with the parameter that names them: "Support floor", "Contact joint/Slave".
  template <int dim>
  std::vector<std::pair<std::string, BoundaryName>> used_boundaries(const Scene<dim> &scene);

  /// Whether the scene names any boundary with a condition.
  template <int dim>
  bool has_boundary_parts(const Scene<dim> &scene);
} // namespace slipstick::scene
