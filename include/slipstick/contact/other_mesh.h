// Contact carried over from another mesh of the same scene.
#pragma once

#include <slipstick/contact/dual_solution.h>
#include <slipstick/contact/result.h>

#include <optional>
#include <string>
#include <vector>

namespace slipstick::contact
{
  /// The contact nodes of a load step on another mesh, the same on all ranks.
  struct ContactOfMesh
  {
    std::vector<std::string> pairs; // names by ContactNode::pair
    std::vector<ContactNode> nodes;
  };

  /// Multipliers and gradient from which Newton's method predicts its first active set: tractions, gaps and slip,
  /// interpolated between the nodes of the other mesh. The multipliers of all other rows are zero; the first face
  /// problem finds them. Nothing if a pair has no nodes there.
  /// @param pairs names by tfeti::ContactPoint::pair. Collective.
  std::optional<DualSolution> start_from(const ContactOfMesh            &other,
                                         const tfeti::DualProblem       &dual,
                                         const std::vector<std::string> &pairs);
} // namespace slipstick::contact
