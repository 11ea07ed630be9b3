// Refinement of plain lists of cells, without hanging nodes. New vertices on edges with curves lie on these.
#pragma once

#include <slipstick/mesh/mesh_piece.h>

#include <set>

namespace slipstick::mesh
{
  /// Divides every cell into four of its own kind, in space into eight. Existing vertices keep their numbers.
  template <int dim>
  MeshPiece<dim> refined(const MeshPiece<dim> &piece);
  template <>
  MeshPiece<3> refined(const MeshPiece<3> &piece);

  /// Divides every triangle into three quadrilaterals, every quadrilateral into four. Existing vertices keep their
  /// numbers.
  template <int dim>
  MeshPiece<dim> in_quadrilaterals(const MeshPiece<dim> &piece);

  /// Refines the cells that touch a boundary of @p ids, once. Quadrilaterals are divided into nine, their neighbours by
  /// templates for one to three marked corners (after R. Schneiders, Refining quadrilateral and hexahedral element
  /// meshes, 1996; the templates for two opposite and three corners are our own and keep the marks from spreading).
  /// Triangles are divided into four, their neighbours into two (red-green). Cells must be of one kind. Vertices keep
  /// their numbers. In space tetrahedra alone: into eight, their neighbours into two or four.
  template <int dim>
  MeshPiece<dim> refined_towards(const MeshPiece<dim> &piece, const std::set<dealii::types::boundary_id> &ids);
  template <>
  MeshPiece<3> refined_towards(const MeshPiece<3> &piece, const std::set<dealii::types::boundary_id> &ids);

  /// Where a cell of a finer mesh comes from.
  struct CellOrigin
  {
    unsigned int parent     = 0;    // cell of the coarser mesh
    unsigned int child      = 0;    // of its children, counted as they are added
    bool         is_regular = true; // of the parent's shape, or the parent itself: not made by a template between sizes
    bool         is_parent  = true; // it was left as it is
  };

  template <int dim>
  struct RefinedPiece
  {
    MeshPiece<dim>          piece;
    std::vector<CellOrigin> origins; // by cell
  };

  /// Refines the cells for which @p marked holds, once, as refined_towards() does those at a boundary.
  template <int dim>
  RefinedPiece<dim> refined_at(const MeshPiece<dim> &piece, const std::vector<bool> &marked);
} // namespace slipstick::mesh
