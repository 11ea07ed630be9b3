// The polygons of contact_NNN.vtp in space: slave faces between contact nodes.
#pragma once

#include <slipstick/mechanics/spaces.h>
#include <slipstick/scene/scene.h>

#include <cstdint>
#include <map>
#include <vector>

namespace slipstick::app
{
  /// Polygons between contact nodes, which are ordered by pair, then key, in @p number. A facet of degree 2 is drawn as
  /// four polygons of degree 1. The corners of triangles of degree 2 are not contact nodes: the midpoints of the edges
  /// around such a corner form a polygon of their own. Collective.
  std::vector<std::vector<std::int64_t>> contact_faces(
    const scene::Scene<3>                                                     &scene,
    const mesh::Mesh<3>                                                       &mesh,
    const mechanics::Spaces<3>                                                &spaces,
    const std::map<std::pair<unsigned int, mechanics::NodeKey>, std::int64_t> &number);
} // namespace slipstick::app
