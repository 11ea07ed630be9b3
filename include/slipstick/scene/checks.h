// Checks that need more than one section of the scene.
#pragma once

#include <slipstick/scene/parameters.h>
#include <slipstick/scene/scene.h>

namespace slipstick::scene
{
  /// Bodies, their hold, conditions that exclude each other, mesh against decomposition, algorithm against contact.
  /// @throws InputError for the first that fails.
  template <int dim>
  void check_scene(const Scene<dim> &scene, const Parameters &parameters);

  /// What may make the answer wrong although the scene can be solved, with the remedy; a line each.
  template <int dim>
  std::vector<std::string> warnings(const Scene<dim> &scene);
} // namespace slipstick::scene
