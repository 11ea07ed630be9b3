// Materials known by name.
#pragma once

#include <slipstick/scene/parameters.h>

namespace slipstick::scene
{
  /// Their names, as the .prm spells them.
  std::vector<std::string> library_names();

  /// Sets the values of every material of @p names that has a Library, or no subsection and the name of one. To be called
  /// before Parameters::apply(), so that values which the file or an override sets take precedence.
  void apply_library(const Parameters               &parameters,
                     const std::vector<std::string> &names,
                     dealii::ParameterHandler       &prm);
} // namespace slipstick::scene
