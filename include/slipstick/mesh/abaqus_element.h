// Element types of Abaqus.
#pragma once

#include <string>

namespace slipstick::mesh
{
  struct AbaqusElement
  {
    unsigned int dim       = 0; // 1 line, 2 plane or face in space, 3 solid; 0: springs, masses: no cell
    unsigned int n_nodes   = 0;
    unsigned int n_corners = 0;
    std::string  problem; // why it is not supported; empty if it is supported
  };

  /// Properties of the element type @p type (in capitals: CPS4R, C3D10). Variants with reduced integration,
  /// incompatible modes or hybrid formulation have the same nodes.
  AbaqusElement abaqus_element(const std::string &type);
} // namespace slipstick::mesh
