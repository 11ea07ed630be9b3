// Named numbers in a .prm: set Variables = d = 0.05; mu = 0.2, used in other values as {mu} or {10 - d/2}.
#pragma once

#include <slipstick/scene/prm_file.h>

namespace slipstick::scene
{
  /// Evaluates the top-level parameter Variables and overrides of single variables ("Variables/mu"), and replaces every
  /// {EXPRESSION} in the other values by its value. Variables may use earlier ones. If the scene has no variables,
  /// braces are ordinary characters. Overrides of single variables are removed from @p settings, and their values are
  /// inserted into Variables.
  /// @throws InputError, with the place, for a name that is not allowed, an expression that cannot be evaluated or is
  /// not a finite number, an override of a variable that does not exist, and an unmatched brace.
  void expand_variables(std::vector<Setting> &settings);
} // namespace slipstick::scene
