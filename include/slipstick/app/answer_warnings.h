// Warnings about an answer that was found: violated assumptions of the theory, and input that is probably a mistake.
#pragma once

#include <slipstick/contact/checks.h>
#include <slipstick/mechanics/spaces.h>

#include <map>

namespace slipstick::app
{
  /// Texts of the warnings of one load step, with remedies, keyed by subject (a kind, with the contact pair): sides
  /// that overlap, or slide past each other, by more than an element; pressure above the modulus; strain, rotation and
  /// motion beyond small displacements; moduli in other units; forces whose split between pairs is not determined.
  /// Collective.
  /// @param free owned rows whose multiplier is strictly inside its bounds.
  /// @param nodes contact nodes of this rank with the points that they belong to at the front of Constraints.
  template <int dim>
  std::map<std::string, std::string> answer_warnings(const scene::Scene<dim>                 &scene,
                                                     const mesh::Mesh<dim>                   &mesh,
                                                     const mechanics::Spaces<dim>            &spaces,
                                                     const tfeti::DualProblem                &dual,
                                                     const std::vector<bool>                 &free,
                                                     const std::vector<contact::ContactNode> &nodes,
                                                     const std::vector<Eigen::VectorXd>      &u);
} // namespace slipstick::app
