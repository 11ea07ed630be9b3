// Multipliers on parts of a slave surface that supports hold.
#pragma once

#include <slipstick/interface/mortar_row.h>
#include <slipstick/mechanics/surface_facet.h>
#include <slipstick/mesh/mesh.h>

namespace slipstick::interface
{
  /// Gives the rows of slave nodes that supports hold along their normal to the nearest nodes, on the same facets, that are not
  /// held. The displacements in such a row are those of the master alone. Where the slave's mesh is finer there are more of these
  /// rows than master nodes that they move: forces on them are not unique, and if all are closed or stick their gaps contradict
  /// each other. The sum of the test functions stays 1, so that equal pressures are still a uniform pressure (as at cross points:
  /// Wohlmuth 2000, section 1.2; Puso, Laursen 2004, section 4.3). A row with one master node, and one without such a
  /// neighbour, stays.
  /// @param all boundary faces of all bodies. @param slave those of the slave side.
  void give_held_rows_to_neighbours(const scene::Scene<3>                      &scene,
                                    const mesh::Mesh<3>                        &mesh,
                                    const std::vector<mechanics::SurfaceFacet> &all,
                                    const std::vector<mechanics::SurfaceFacet> &slave,
                                    std::vector<MortarRow<3>>                  &rows);
} // namespace slipstick::interface
