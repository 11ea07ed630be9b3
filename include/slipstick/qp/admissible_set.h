// Where the multipliers of a problem may be.
#pragma once

#include <slipstick/qp/box.h>
#include <slipstick/qp/pressure_bounds.h>

#include <vector>

namespace slipstick::qp
{
  /// Where multipliers may be: in a box, tangential ones within bounds that may follow normal ones (they are set in the
  /// box as x moves). All refer to entries of this process.
  template <typename Vector>
  struct AdmissibleSet
  {
    Box<Vector>                box;
    std::vector<PressureBound> pressure_bounds;
  };
} // namespace slipstick::qp
