// Checks that need more than one section of the scene.
#pragma once

#include <slipstick/scene/parameters.h>
#include <slipstick/scene/scene.h>

namespace slipstick::scene
{
  /// Checks bodies, their supports, mutually exclusive conditions, mesh against decomposition, algorithm against
  /// contact.
  /// @throws InputError for the first check that fails.
  template <int dim>
  void check_scene(const Scene<dim> &scene, const Parameters &parameters);

  /// Warnings, with remedies, about input that can be solved but may give a wrong solution; one line each.
  template <int dim>
  std::vector<std::string> warnings(const Scene<dim> &scene);
} // namespace slipstick::scene
