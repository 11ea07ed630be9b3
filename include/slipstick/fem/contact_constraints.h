// From meshes, supports and contact pairs to the rows of B.
#pragma once

#include <slipstick/fem/spaces.h>
#include <slipstick/tfeti/constraints.h>

namespace slipstick::fem
{
  /// Gluing, prescribed displacements (at load factor @p t) and contact of the scene, distributed over the ranks.
  /// Copies of a node meet on a rank found from its key; nothing global is held anywhere. Gluing rows are
  /// non-redundant chains over the copies. A contact node on a support keeps only the rows that the support leaves
  /// independent. Collective.
  /// @throws InputError when two supports prescribe different values for one component of a node.
  template <int dim>
  tfeti::Constraints contact_constraints(const scene::Scene<dim> &scene,
                                         const Mesh<dim>         &mesh,
                                         const Spaces<dim>       &spaces,
                                         const double             t);
} // namespace slipstick::fem
