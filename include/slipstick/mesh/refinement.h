// Refinement of plain lists of cells, without hanging nodes. New vertices on edges with curves lie on these.
#pragma once

#include <slipstick/mesh/mesh_piece.h>

#include <set>

namespace slipstick::mesh
{
  /// Every cell in four of its own kind. Vertices that were there keep their numbers.
  template <int dim>
  MeshPiece<dim> refined(const MeshPiece<dim> &piece);

  /// Every triangle in three quadrilaterals, every quadrilateral in four. Vertices keep their numbers.
  template <int dim>
  MeshPiece<dim> in_quadrilaterals(const MeshPiece<dim> &piece);

  /// Refines the cells that touch a boundary of @p ids, once. Quadrilaterals in nine, their neighbours by templates for
  /// one to three marked corners (after R. Schneiders, Refining quadrilateral and hexahedral element meshes, 1996; the
  /// templates for two opposite and three corners are our own and keep the marks from spreading). Triangles in four,
  /// their neighbours in two (red-green). Cells must be of one kind. Vertices keep their numbers.
  template <int dim>
  MeshPiece<dim> refined_towards(const MeshPiece<dim> &piece, const std::set<dealii::types::boundary_id> &ids);
} // namespace slipstick::mesh
