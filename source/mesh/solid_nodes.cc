#include <slipstick/mesh/solid_nodes.h>

namespace slipstick::mesh
{
  const std::vector<std::vector<unsigned int>> &middles_of_solid(const NodeOrder order, const unsigned int n_nodes)
  {
    using Middles = std::vector<std::vector<unsigned int>>;
    static const Middles none,
      gmsh_tetrahedron   = {{0, 1}, {1, 2}, {2, 0}, {3, 0}, {2, 3}, {1, 3}},
      abaqus_tetrahedron = {{0, 1}, {1, 2}, {2, 0}, {0, 3}, {1, 3}, {2, 3}},
      gmsh_hexahedron    = {{0, 1},
                            {0, 3},
                            {0, 4},
                            {1, 2},
                            {1, 5},
                            {2, 3},
                            {2, 6},
                            {3, 7},
                            {4, 5},
                            {4, 7},
                            {5, 6},
                            {6, 7},
                            {0, 3, 2, 1},
                            {0, 1, 5, 4},
                            {0, 4, 7, 3},
                            {1, 2, 6, 5},
                            {2, 3, 7, 6},
                            {4, 5, 6, 7},
                            {0, 1, 2, 3, 4, 5, 6, 7}},
      abaqus_hexahedron =
        {{0, 1}, {1, 2}, {2, 3}, {3, 0}, {4, 5}, {5, 6}, {6, 7}, {7, 4}, {0, 4}, {1, 5}, {2, 6}, {3, 7}},
      vtk_hexahedron   = {{0, 1},
                          {1, 2},
                          {2, 3},
                          {3, 0},
                          {4, 5},
                          {5, 6},
                          {6, 7},
                          {7, 4},
                          {0, 4},
                          {1, 5},
                          {2, 6},
                          {3, 7},
                          {0, 4, 7, 3},
                          {1, 2, 6, 5},
                          {0, 1, 5, 4},
                          {3, 7, 6, 2},
                          {0, 3, 2, 1},
                          {4, 5, 6, 7},
                          {0, 1, 2, 3, 4, 5, 6, 7}};
    const bool is_gmsh = order == NodeOrder::gmsh;
    if (n_nodes == 10)
      return is_gmsh ? gmsh_tetrahedron : abaqus_tetrahedron;
    if (n_nodes == 20)
      return is_gmsh ? gmsh_hexahedron : abaqus_hexahedron;
    if (n_nodes == 27 && order != NodeOrder::abaqus)
      return is_gmsh ? gmsh_hexahedron : vtk_hexahedron;
    return none;
  }
} // namespace slipstick::mesh
