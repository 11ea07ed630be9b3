// Where loads are drawn that act on no boundary: in bodies, about axes, across sections.
#pragma once

#include <slipstick/mesh/mesh.h>

#include <string>
#include <vector>

namespace slipstick::output
{
  /// A body force, change of temperature or bolt, in one body, at the load step in which it is largest.
  template <int dim>
  struct LoadPlace
  {
    std::string  kind;     // "body force", "temperature", "pretension"
    std::string  name;     // of the load
    std::string  side;     // "": in the middle of the body; "axis" of a rotation or bolt; "section" of a bolt
    unsigned int body = 0; // index into Scene::bodies
    std::vector<dealii::Point<dim>> ends;  // one, two, or four around a section in space [mm]
    dealii::Tensor<1, dim>          force; // body force in the middle, without that of a rotation [N/mm^3]
    double value = 0;                      // its length, angular velocity [1/s], change of temperature [K], tension [N]
  };

  /// All of the scene, in its order, the same on all ranks and up to rounding for all decompositions. Collective.
  template <int dim>
  std::vector<LoadPlace<dim>> load_places(const scene::Scene<dim> &scene, const mesh::Mesh<dim> &mesh);
} // namespace slipstick::output
