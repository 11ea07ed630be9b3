// A picture of the scene before it is solved.
#pragma once

#include <slipstick/mechanics/spaces.h>
#include <slipstick/output/directory.h>

namespace slipstick::output
{
  /// Writes an SVG file of name @p file from rank 0: meshes (outlines alone where there are many cells), supports,
  /// loads, contact pairs and obstacles with a legend of their names; arrows of loads in the load step in which they
  /// are largest. Collective.
  void write_scene_picture(const OutputDirectory      &directory,
                           const std::string          &file,
                           const scene::Scene<2>      &scene,
                           const mesh::Mesh<2>        &mesh,
                           const mechanics::Spaces<2> &spaces);
} // namespace slipstick::output
