// A picture of the scene before it is solved.
#pragma once

#include <slipstick/mechanics/spaces.h>
#include <slipstick/output/directory.h>

namespace slipstick::output
{
  /// Writes an SVG file of name @p file from rank 0: meshes (only outlines for large meshes), supports, loads,
  /// temperatures, bolts, contact pairs and obstacles with a legend of their names; arrows of loads for the load step
  /// in which they are largest. Solids are viewed from the front, right and above; conditions on their far side are
  /// visible through them, and obstacles from a height function or a file are omitted. Collective.
  template <int dim>
  void write_scene_picture(const OutputDirectory        &directory,
                           const std::string            &file,
                           const scene::Scene<dim>      &scene,
                           const mesh::Mesh<dim>        &mesh,
                           const mechanics::Spaces<dim> &spaces);
} // namespace slipstick::output
