// Places at which loads that do not act on a boundary are drawn: inside bodies, at axes, at sections.
#pragma once

#include <slipstick/mesh/mesh.h>

#include <string>
#include <vector>

namespace slipstick::output
{
  /// A body force, change of temperature or bolt in one body, at the load step in which it is largest.
  template <int dim>
  struct LoadPlace
  {
    std::string  kind;     // "body force", "temperature", "pretension"
    std::string  name;     // of the load
    std::string  side;     // "": in the middle of the body; "axis" of a rotation or bolt; "section" of a bolt
    unsigned int body = 0; // index into Scene::bodies
    std::vector<dealii::Point<dim>> ends;  // one, two, or in space four around a section [mm]
    dealii::Tensor<1, dim>          force; // body force at the centre, without centrifugal force [N/mm^3]
    double value = 0; // magnitude of the force, angular velocity [1/s], temperature change [K] or tension [N]
  };

  /// All such loads, in the order of the scene; the same on all ranks and, up to rounding, for all decompositions.
  /// Collective.
  template <int dim>
  std::vector<LoadPlace<dim>> load_places(const scene::Scene<dim> &scene, const mesh::Mesh<dim> &mesh);
} // namespace slipstick::output
