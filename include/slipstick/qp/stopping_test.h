// The stopping test of the semismooth Newton method.
#pragma once

#include <slipstick/qp/kernels.h>
#include <slipstick/qp/newton_point.h>
#include <slipstick/qp/options.h>
#include <slipstick/qp/types.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <optional>
#include <utility>

namespace slipstick::qp
{
  /// Whether the estimated error of x (M r of the face) is small in the quantities that matter. Called once the goal is
  /// reached; if false, the method continues to smaller residuals. Must return the same on every process.
  template <typename Vector>
  using ErrorTest = std::function<bool(const Vector &x, const Vector &error)>;

  namespace detail
  {
    /// Decides whether a point is the solution, keeps the best point so far, and sets the tolerance of faces.
    template <typename Vector>
    class StoppingTest
    {
    public:
      struct Best
      {
        PointWithGradient<Vector> point;
        double                    residual; // relative to the reference
      };

      /// Keeps references to all arguments except the goal. @param norm_ |PFP|
      StoppingTest(const Goal              &goal_,
                   const double             norm_,
                   const NewtonOptions     &options_,
                   const ErrorTest<Vector> &is_right_)
        : goal(goal_)
        , norm(norm_)
        , options(options_)
        , is_right(is_right_)
        , tolerance(goal_.tolerance)
      {}

      /// Relative residual to which faces are solved: the tolerance of the goal, or less if a point that met it was
      /// refused.
      double tolerance_of_faces() const
      {
        return tolerance;
      }

      /// Whether a point met the goal but was refused.
      bool has_met_goal() const
      {
        return is_met;
      }

      /// Whether this point, which meets the goal, is the solution. If not, it is kept as the best, and faces are
      /// solved to a smaller residual from now on.
      /// @param residual of the face, over the reference. @param left all residuals together, over the reference.
      /// @param size of the forces at that point. @param error returns the estimated error of that point
      template <typename Error>
      bool accepts(const PointWithGradient<Vector> &at,
                   const double                     residual,
                   const double                     left,
                   const double                     size,
                   const Error                     &error)
      {
        best = Best{at, residual};
        if (left <= options.least_part * goal.tolerance ||
            (is_small_beside_forces(left, size) && (!is_right || is_right(at.x, error()))))
          return true;
        is_met    = true;
        tolerance = options.tightening * left;
        return false;
      }

      /// Called after a face that was solved to @p residual; @p with_bounds also counts by how much the bounds are
      /// violated. Both over the reference. Faces may meet the goal on sets whose bounds are violated by far more than
      /// before. If that happens again, gradients below the goal determine the sets (very different compliances), and
      /// faces are solved to a smaller residual.
      void check_start_of_face(const double residual, const double with_bounds)
      {
        if (residual <= goal.tolerance &&
            with_bounds > options.divergence_factor * std::max(goal.tolerance, last_with_bounds) && ++n_divergences > 1)
          tolerance = std::min(tolerance, options.tightening * residual);
        last_with_bounds = with_bounds;
      }

      /// Keeps the point as the best one; its natural residual is the smallest so far.
      void propose(const PointWithGradient<Vector> &at, const double residual)
      {
        if (!is_met)
          best = Best{at, residual};
      }

      /// The point with the smallest natural residual, or the one that met the goal last.
      std::optional<Best> take_best()
      {
        return std::exchange(best, std::nullopt);
      }

    private:
      // Whether the residual is small compared with the forces, too: if open gaps determine the reference, the forces
      // may be negligible beside it.
      bool is_small_beside_forces(const double left, const double size) const
      {
        return left * goal.reference <= options.gaps_over_forces * goal.tolerance * norm * size;
      }

      const Goal               goal;
      const double             norm;
      const NewtonOptions     &options;
      const ErrorTest<Vector> &is_right;

      double              tolerance;
      bool                is_met = false;
      std::optional<Best> best;
      double              last_with_bounds = std::numeric_limits<double>::infinity();
      unsigned int        n_divergences    = 0;
    };
  } // namespace detail
} // namespace slipstick::qp
