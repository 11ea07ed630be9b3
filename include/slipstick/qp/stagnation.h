// When to give up: a residual that has not fallen for too long.
#pragma once

#include <cmath>
#include <limits>

namespace slipstick::qp
{
  /// Told the residual of every step, says whether to give up: the least one so far has not fallen below `progress`
  /// times its old value within `window` steps, or it is not a number.
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
