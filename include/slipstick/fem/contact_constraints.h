// From meshes, supports and contact pairs to the rows of B.
#pragma once

#include <slipstick/fem/spaces.h>
#include <slipstick/tfeti/constraints.h>

namespace slipstick::fem
{
  /// Gluing, bonds, prescribed displacements (at load factor @p t), foundations and contact of the scene, distributed
  /// over the ranks. Copies of a node meet on a rank found from its key; of global data there are the outlines of bodies
  /// in contact with each other alone, on every rank. Gluing rows are non-redundant chains over the copies; rows that
  /// share a node are owned by one rank. Which rows a node has: RowBuilder; what they say: mortar_rows(), contact_with().
  /// Collective.
  /// @throws InputError on all ranks when supports contradict each other, or the sides of a contact pair do not meet.
  template <int dim>
  tfeti::Constraints contact_constraints(const scene::Scene<dim> &scene,
                                         const Mesh<dim>         &mesh,
                                         const Spaces<dim>       &spaces,
                                         const double             t);
} // namespace slipstick::fem
