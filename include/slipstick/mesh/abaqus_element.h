// Abaqus' types of elements.
#pragma once

#include <string>

namespace slipstick::mesh
{
  struct AbaqusElement
  {
    unsigned int dim = 0; // 1 line, 2 of the plane or a face in space, 3 solid; 0: springs, masses: no part of a mesh
    unsigned int n_nodes   = 0;
    unsigned int n_corners = 0;
    std::string  problem; // why it is not supported; empty if it is
  };

  /// What @p type (in capitals: CPS4R, C3D10) is. Variants with reduced integration, incompatible modes or hybrid formulation have the
  /// same nodes.
  AbaqusElement abaqus_element(const std::string &type);
} // namespace slipstick::mesh
