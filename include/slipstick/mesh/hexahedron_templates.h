// Templates for hexahedra with marked corners, after R. Schneiders, Refining quadrilateral and hexahedral element
// meshes (1996).
//
// Corners of cells and templates are numbered as in deal.II: bit d is set if coordinate d is 1.
#pragma once

#include <deal.II/base/tensor.h>

#include <array>
#include <map>
#include <vector>

namespace slipstick::mesh
{
  /// Position in a cell whose edges are divided into n_parts parts, in multiples of these.
  using Place = std::array<unsigned int, 3>;

  constexpr unsigned int n_parts = 6;

  dealii::Tensor<1, 3> vector_of(const Place &place);

  /// Corners of a part of a cell.
  using Hexahedron = std::array<Place, 8>;

  using Template = std::vector<Hexahedron>;

  /// Set of corners of a cell, as bits.
  using Marks = unsigned int;

  constexpr Marks all_corners = 0xff;

  /// The template for every set of marks that has one: one corner (4 cells), an edge (11), a face (22), all corners
  /// (27).
  const std::map<Marks, Template> &templates_by_marks();

  /// The corners of the smallest corner, edge, face or cell that has all of @p marks.
  Marks convex(Marks marks);
} // namespace slipstick::mesh
