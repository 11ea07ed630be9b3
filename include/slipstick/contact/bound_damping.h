// Damping of slip bounds that are updated from solution to solution.
#pragma once

#include <slipstick/qp/box.h>

#include <algorithm>

namespace slipstick::contact
{
  /// The part of the way to the next bounds that an update takes: halved whenever their change has not fallen for a while.
  class BoundDamping
  {
  public:
    /// @param change of the bounds, relative.
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
    // The change must fall by this part, times the damping, of the least ...
    static constexpr double cycling_progress = 0.1;
    // ... within so many updates.
    static constexpr unsigned int cycling_window = 5;
    // Damping is halved down to this.
    static constexpr double least_relaxation = 0.1;

    double       relaxation     = 1;
    double       least_change   = qp::infinity;
    unsigned int updates_in_row = 0; // without progress
  };
} // namespace slipstick::contact
