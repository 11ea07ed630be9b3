// Mesh of a body from its description.
#pragma once

#include <slipstick/mesh/adaptive_refinement.h>
#include <slipstick/mesh/body_mesh.h>

namespace slipstick::mesh
{
  /// The complete mesh of body number @p b: read or generated, refined, placed. @p files caches the files by path. A
  /// body of triangles and quadrilaterals is converted to quadrilaterals if it is refined towards a boundary or if it
  /// has many small parts with one kind of cells.
  /// @param refined cells to be refined further, see adapted(), with the @p paths of the cells; such a body also has
  /// one kind of cells, in space tetrahedra.
  /// @throws InputError as body_from_file() does, and if a boundary or point that the scene uses is missing or
  /// incomplete.
  template <int dim>
  BodyMesh<dim> make_body(const scene::Scene<dim>         &scene,
                          const unsigned int               b,
                          std::map<std::string, MeshFile> &files,
                          std::set<CellPath>              *refined = nullptr,
                          std::vector<CellPath>           *paths   = nullptr);

  /// Places a piece of body number @p b as described in the scene. In bodies of revolution, nodes within rounding of
  /// the axis are moved onto it.
  /// @throws InputError when a body of revolution extends beyond the axis.
  template <int dim>
  void place_in_scene(const scene::Scene<dim> &scene, const unsigned int b, MeshPiece<dim> &piece);
} // namespace slipstick::mesh
