// Numbers with names in a .prm: set Variables = d = 0.05; mu = 0.2, used in other values as {mu} or {10 - d/2}.
#pragma once

#include <slipstick/scene/prm_file.h>

namespace slipstick::scene
{
  /// Evaluates the top-level parameter Variables and overrides of single ones ("Variables/mu"), and replaces every
  /// {EXPRESSION} in the other values by its number. Variables may use those before them. Where the scene has no
  /// variables, braces are ordinary characters. The overrides of single variables are taken out of @p settings, their
  /// values put into Variables.
  /// @throws InputError, with the place, for a name that is not allowed, an expression that cannot be evaluated or is not
  /// a finite number, an override of a variable that the scene does not have, and a brace without its partner.
  void expand_variables(std::vector<Setting> &settings);
} // namespace slipstick::scene
