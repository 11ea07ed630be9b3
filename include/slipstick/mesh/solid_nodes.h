// Positions of the nodes of second-order solids, in the orders of mesh files.
#pragma once

#include <vector>

namespace slipstick::mesh
{
  enum class NodeOrder
  {
    gmsh,
    abaqus,
    vtk // as Abaqus', followed by nodes in the middle of faces
  };

  /// The corners between which the nodes after the corners lie: two of an edge, four of a face, eight of the cell.
  /// @param n_nodes 10, 20, 27 (not Abaqus'); empty result for other cells.
  const std::vector<std::vector<unsigned int>> &middles_of_solid(const NodeOrder order, const unsigned int n_nodes);
} // namespace slipstick::mesh
