// Meshes of quadrilaterals for the built-in shapes of bodies.
#pragma once

#include <slipstick/mesh/body_mesh.h>

namespace slipstick::mesh
{
  // Discs and balls: a square or cube with curved sides in the centre, surrounded by layers of cells.
  constexpr double core_radius  = 0.55; // of its corners, relative to the radius: cells of about equal size
  constexpr double core_bending = 0.4;  // 0: plane sides, 1: arcs or parts of a sphere

  /// Cells of a rectangle per direction, including refinements.
  template <int dim>
  std::array<unsigned int, dim> rectangle_cells(const scene::Scene<dim> &scene, const scene::Body<dim> &body);

  struct RoundBarCells
  {
    unsigned int across, along; // from the inner to the outer surface (0: no tube); in axial direction
  };

  /// Numbers of cells of a cylinder or tube, before refinements.
  RoundBarCells round_bar_cells(const scene::Body<3> &body);

  /// Boundary ids of a built-in shape, in the order of scene::boundary_names(); in space (@p dim = 3) rectangles are
  /// cuboids.
  std::map<std::string, dealii::types::boundary_id> shape_boundary_ids(const scene::Shape shape,
                                                                       const unsigned int dim = 2);
} // namespace slipstick::mesh
