// Parameters set by the presets of Accuracy.
#pragma once

#include <slipstick/scene/parameters.h>

#include <string>
#include <utility>
#include <vector>

namespace slipstick::scene
{
  /// Names of the presets as in the .prm, from coarse to fine.
  std::vector<std::string> accuracy_names();

  /// The individual parameters set by a preset, with their values: {"Solver/Tolerance", "1e-3"}.
  std::vector<std::pair<std::string, std::string>> knobs_of_accuracy(const std::string &preset);

  /// Sets the parameters of the preset named in @p parameters; if meshes of solids are refined, the degree is always 2.
  /// Must be called before Parameters::apply(), so that parameters set by the file or an override take precedence.
  /// @throws InputError when there is no such preset.
  void apply_accuracy(const Parameters &parameters, const unsigned int dim, dealii::ParameterHandler &prm);
} // namespace slipstick::scene
