// Multipliers on parts of a slave surface that are held by supports.
#pragma once

#include <slipstick/interface/mortar_row.h>
#include <slipstick/mechanics/surface_facet.h>
#include <slipstick/mesh/mesh.h>

namespace slipstick::interface
{
  /// Removes the rows of slave nodes that supports hold along their normal and adds them to the nearest nodes on the
  /// same facets that are not held. Such a row contains displacements of the master only. If the slave mesh is finer,
  /// there are more of these rows than master nodes in them: the forces on them are not unique, and if all are closed
  /// or stick their gaps contradict each other. The sum of the test functions remains 1, so that equal pressures are
  /// still a uniform pressure (as at cross points: Wohlmuth 2000, section 1.2; Puso, Laursen 2004, section 4.3). A row
  /// with one master node, or without such a neighbour, is kept.
  /// @param all boundary faces of all bodies. @param slave boundary faces of the slave side.
  void give_held_rows_to_neighbours(const scene::Scene<3>                      &scene,
                                    const mesh::Mesh<3>                        &mesh,
                                    const std::vector<mechanics::SurfaceFacet> &all,
                                    const std::vector<mechanics::SurfaceFacet> &slave,
                                    std::vector<MortarRow<3>>                  &rows);
} // namespace slipstick::interface
