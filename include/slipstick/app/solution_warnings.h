// Warnings about a solution: violated assumptions of the theory, and input that is probably wrong.
#pragma once

#include <slipstick/contact/checks.h>
#include <slipstick/mechanics/spaces.h>

#include <map>

namespace slipstick::app
{
  /// Texts of the warnings of one load step, with remedies, keyed by subject (a kind, with the contact pair): sides
  /// that overlap, or slide past each other, by more than an element; pressure above the modulus; strains, rotations
  /// and displacements that are not small; bodies whose forces are not balanced where the displacements take them; moduli in other units; forces whose distribution over pairs is not unique.
  /// Collective.
  /// @param multipliers of the displacements @p u, without the parts of pretensioned bolts.
  /// @param free owned rows whose multiplier is strictly inside its bounds.
  /// @param nodes contact nodes of this rank; the first ones correspond to the points of Constraints.
  template <int dim>
  std::map<std::string, std::string> solution_warnings(const scene::Scene<dim>                 &scene,
                                                       const mesh::Mesh<dim>                   &mesh,
                                                       const mechanics::Spaces<dim>            &spaces,
                                                       const tfeti::DualProblem                &dual,
                                                       const tfeti::DistributedVector          &multipliers,
                                                       const std::vector<bool>                 &free,
                                                       const std::vector<contact::ContactNode> &nodes,
                                                       const std::vector<Eigen::VectorXd>      &u);
} // namespace slipstick::app
