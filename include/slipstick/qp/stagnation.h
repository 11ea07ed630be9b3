// Stopping test for residuals that no longer decrease.
#pragma once

#include <cmath>
#include <limits>

namespace slipstick::qp
{
  /// Receives the residual of every step; returns true to stop: the smallest residual so far has not decreased below
  /// `progress` times its old value within `window` steps, or the residual is not a number.
  class StagnationWatch
  {
  public:
    StagnationWatch(const unsigned int window_, const double progress_)
      : window(window_)
      , progress(progress_)
    {}

    bool operator()(const double residual)
    {
      if (residual < progress * least)
        {
          least = residual;
          idle  = 0;
        }
      else
        ++idle;
      return !std::isfinite(residual) || idle > window;
    }

  private:
    unsigned int window;
    double       progress;
    double       least = std::numeric_limits<double>::infinity();
    unsigned int idle  = 0;
  };
} // namespace slipstick::qp
