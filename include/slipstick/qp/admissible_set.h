// The admissible set of the multipliers.
#pragma once

#include <slipstick/qp/box.h>
#include <slipstick/qp/pressure_bounds.h>

#include <vector>

namespace slipstick::qp
{
  /// Admissible multipliers: a box; bounds of tangential entries may follow normal ones (the box is updated as x
  /// moves). All indices refer to entries of this process.
  template <typename Vector>
  struct AdmissibleSet
  {
    Box<Vector>                box;
    std::vector<PressureBound> pressure_bounds;
  };
} // namespace slipstick::qp
