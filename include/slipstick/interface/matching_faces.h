// Contact of solids whose meshes match: node to node.
#pragma once

#include <slipstick/interface/mortar.h>
#include <slipstick/mechanics/surface_face.h>

namespace slipstick::interface
{
  /// The rows of the slave nodes that have a master node across: as mortar_rows() node to node. Normals are means of both
  /// sides, tributary areas those of the slave faces all of whose nodes have one. A pair without a reach of its own pairs
  /// nodes up to the smallest gap and half the extent of the smaller side besides (a tenth where the law acts on open nodes).
  /// @throws InputError for sides that do not face each other, and where faces of one side face those of the other
  /// without matching them.
  std::vector<MortarRow<3>> matching_rows(const scene::Scene<3>                     &scene,
                                          const scene::ContactPair<3>               &pair,
                                          const std::vector<mechanics::SurfaceFace> &slave,
                                          const std::vector<mechanics::SurfaceFace> &master);
} // namespace slipstick::interface
