// Line search of the semismooth Newton method on the natural residual, which costs no multiplication along a step.
#pragma once

#include <slipstick/qp/kernels.h>
#include <slipstick/qp/newton_point.h>
#include <slipstick/qp/options.h>

#include <optional>
#include <utility>

namespace slipstick::qp::detail
{
  /// A step must end below the natural residual of the present point, by a part that grows with its length (Armijo
  /// 1966).
  /// @tparam Set with natural_residual(x, gradient), as ActiveSet
  template <typename Vector, typename Set>
  class LineSearch
  {
  public:
    using Point = PointWithGradient<Vector>;

    /// @param options_ is kept by reference.
    explicit LineSearch(const NewtonOptions &options_)
      : options(&options_)
    {}

    /// Starts from a point with this natural residual.
    void begin(const double residual)
    {
      at_present = residual;
    }

    /// Natural residual of the present point.
    double present() const
    {
      return at_present;
    }

    /// Length t <= 1 of a step from one point towards the other, found by backtracking, for which the residual falls
    /// below that of the present point; 0 if there is none.
    double search(Set &set, const Point &from, const Point &to)
    {
      residual_of_step = set.natural_residual(to.x, to.gradient);
      double t         = 1;
      while (!(residual_of_step <= (1 - options->sufficient_decrease * t) * at_present))
        {
          if (t < 1)
            nearest_refused.emplace(*std::move(end_of_step));
          else
            nearest_refused.emplace(to);
          t *= options->backtracking;
          if (t < least_part_of_step)
            return 0;
          // Not assigned: deal.II compares the partitioners of two vectors collectively unless both share one object,
          // and after moves some ranks shared it while others did not.
          end_of_step.emplace(to);
          combine(1 - t, from.x, t, end_of_step->x);
          combine(1 - t, from.gradient, t, end_of_step->gradient);
          residual_of_step = set.natural_residual(end_of_step->x, end_of_step->gradient);
        }
      return t;
    }

    /// Natural residual at the end of the last step found.
    double found() const
    {
      return residual_of_step;
    }

    /// The end of that step, if it was cut.
    Point &end()
    {
      return *end_of_step;
    }

    /// The point nearest to x that the last search that cut a step refused.
    const Point &refused() const
    {
      return *nearest_refused;
    }

  private:
    // Steps on nearly singular faces may be far too long.
    static constexpr double least_part_of_step = 1e-10;

    const NewtonOptions *options;
    double               at_present = 0, residual_of_step = 0;
    std::optional<Point> end_of_step, nearest_refused;
  };
} // namespace slipstick::qp::detail
