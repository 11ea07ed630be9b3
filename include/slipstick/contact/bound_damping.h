// Damping of slip bounds in the fixed-point iteration.
#pragma once

#include <slipstick/qp/box.h>

#include <algorithm>

namespace slipstick::contact
{
  /// Relaxation factor for the update of the slip bounds: halved when their change has not decreased for several
  /// updates.
  class BoundDamping
  {
  public:
    /// @param change relative change of the bounds. @return the relaxation factor.
    double operator()(const double change)
    {
      if (change < (1 - cycling_progress * relaxation) * least_change)
        {
          least_change   = change;
          updates_in_row = 0;
        }
      else if (++updates_in_row >= cycling_window)
        {
          relaxation     = std::max(relaxation / 2, least_relaxation);
          updates_in_row = 0;
          least_change   = change;
        }
      return relaxation;
    }

  private:
    // Progress: the change falls below its smallest value so far by this fraction, times the relaxation factor, ...
    static constexpr double cycling_progress = 0.1;
    // ... within this number of updates.
    static constexpr unsigned int cycling_window = 5;
    // Lower limit of the relaxation factor.
    static constexpr double least_relaxation = 0.1;

    double       relaxation     = 1;
    double       least_change   = qp::infinity;
    unsigned int updates_in_row = 0; // consecutive updates without progress
  };
} // namespace slipstick::contact
