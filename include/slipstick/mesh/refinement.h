// Refinement of plain lists of cells without hanging nodes. New vertices on edges with curves are on these curves.
#pragma once

#include <slipstick/mesh/refined_piece.h>

#include <set>

namespace slipstick::mesh
{
  /// Divides every cell into four, in space eight, of its own kind. Existing vertices keep their numbers.
  template <int dim>
  MeshPiece<dim> refined(const MeshPiece<dim> &piece);
  template <>
  MeshPiece<3> refined(const MeshPiece<3> &piece);

  /// Divides every triangle into three quadrilaterals, every quadrilateral into four. Existing vertices keep their
  /// numbers.
  template <int dim>
  MeshPiece<dim> in_quadrilaterals(const MeshPiece<dim> &piece);

  /// Divides every hexahedron into six tetrahedra that share its first vertex along a direction oblique to all axes;
  /// faces are cut along the diagonal from their first vertex, so that matching surfaces of two bodies still match.
  /// Vertices keep their numbers.
  /// @param places of the vertices in the scene, which determine their order.
  /// @throws InputError for a hexahedron so distorted that one of the tetrahedra would be inverted.
  MeshPiece<3> in_tetrahedra(const MeshPiece<3> &piece, const std::vector<dealii::Point<3>> &places);

  /// Refines the cells that touch a boundary of @p ids, once. Quadrilaterals are divided into nine, their neighbours by
  /// templates for one to three marked corners (after R. Schneiders, Refining quadrilateral and hexahedral element
  /// meshes, 1996; the templates for two opposite and three corners are our own and prevent the marks from spreading).
  /// Triangles are divided into four, their neighbours into two (red-green). Cells must be of one kind. Vertices keep
  /// their numbers. Tetrahedra are divided into eight, their neighbours into two or four; hexahedra as in
  /// hexahedra_refinement.h, at one boundary after the other if the marks of all boundaries together would spread from
  /// where these meet.
  template <int dim>
  MeshPiece<dim> refined_towards(const MeshPiece<dim> &piece, const std::set<dealii::types::boundary_id> &ids);

  /// Refines the cells for which @p marked holds, once, in the same way as refined_towards().
  template <int dim>
  RefinedPiece<dim> refined_at(const MeshPiece<dim> &piece, const std::vector<bool> &marked);
  template <>
  RefinedPiece<3> refined_at(const MeshPiece<3> &piece, const std::vector<bool> &marked);
} // namespace slipstick::mesh
