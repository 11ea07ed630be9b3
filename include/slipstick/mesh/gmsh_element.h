// Element types of Gmsh.
#pragma once

namespace slipstick::mesh
{
  struct GmshElement
  {
    unsigned int dim       = 0; // 0 point, 1 line, 2 triangle or quadrilateral, 3 solid
    unsigned int n_corners = 0;
    unsigned int n_nodes   = 0; // 0: unknown type
  };

  /// Properties of the element type with this number.
  GmshElement gmsh_element(const int type);
} // namespace slipstick::mesh
