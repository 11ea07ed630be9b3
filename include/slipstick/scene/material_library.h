// Library of materials.
#pragma once

#include <slipstick/scene/parameters.h>

namespace slipstick::scene
{
  /// Names of the materials as in the .prm.
  std::vector<std::string> library_names();

  /// Sets the values of every material in @p names that has a Library parameter, or has the name of a library material
  /// and no subsection. Must be called before Parameters::apply(), so that values set by the file or an override take
  /// precedence.
  void apply_library(const Parameters               &parameters,
                     const std::vector<std::string> &names,
                     dealii::ParameterHandler       &prm);
} // namespace slipstick::scene
