// What the presets of Accuracy set.
#pragma once

#include <slipstick/scene/parameters.h>

#include <string>
#include <utility>
#include <vector>

namespace slipstick::scene
{
  /// Names of the presets, as the .prm spells them, from coarse to fine.
  std::vector<std::string> accuracy_names();

  /// The single knobs that a preset sets, with their values: {"Solver/Tolerance", "1e-3"}.
  std::vector<std::pair<std::string, std::string>> knobs_of_accuracy(const std::string &preset);

  /// Sets the knobs of the preset that @p parameters names; where meshes of solids are refined, degree 2 in any case. To be called before Parameters::apply(), so that a knob that
  /// the file or an override sets wins.
  /// @throws InputError when there is no such preset.
  void apply_accuracy(const Parameters &parameters, const unsigned int dim, dealii::ParameterHandler &prm);
} // namespace slipstick::scene
