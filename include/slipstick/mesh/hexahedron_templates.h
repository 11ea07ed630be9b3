// How hexahedra with marked corners are divided: after R. Schneiders, Refining quadrilateral and hexahedral element meshes (1996).
// Corners of cells and templates are numbered as deal.II does: bit d is set where coordinate d is 1.
#pragma once

#include <deal.II/base/tensor.h>

#include <array>
#include <map>
#include <vector>

namespace slipstick::mesh
{
  /// In a cell whose edges have n_parts parts: whole numbers of them.
  using Place = std::array<unsigned int, 3>;

  constexpr unsigned int n_parts = 6;

  dealii::Tensor<1, 3> vector_of(const Place &place);

  /// Corners of a part of a cell.
  using Hexahedron = std::array<Place, 8>;

  using Template = std::vector<Hexahedron>;

  /// Corners of a cell, as bits.
  using Marks = unsigned int;

  constexpr Marks all_corners = 0xff;

  /// The template for every set of marks that has one: one corner (4 cells), an edge (11), a face (22), all (27).
  const std::map<Marks, Template> &templates_by_marks();

  /// The corners of the smallest corner, edge, face or cell that has all of @p marks.
  Marks convex(Marks marks);
} // namespace slipstick::mesh
