// Triangles from .stl files.
#pragma once

#include <deal.II/base/point.h>

#include <string>
#include <vector>

namespace slipstick::scene
{
  /// The corners of all triangles of a file, ASCII or binary, three per triangle. The normals in the file are ignored;
  /// the order of the corners defines the orientation. @throws InputError for a file that cannot be read, is damaged,
  /// or has too many triangles.
  std::vector<dealii::Point<3>> read_stl(const std::string &file);
} // namespace slipstick::scene
