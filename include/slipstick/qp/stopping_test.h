// When the semismooth Newton method may end.
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
  /// Is the estimated error of x, M r of the face, small where it counts? Asked once the goal is reached; else the method
  /// goes on to smaller residuals. On every process with the same result.
  template <typename Vector>
  using ErrorTest = std::function<bool(const Vector &x, const Vector &error)>;

  namespace detail
  {
    /// Whether a point is the solution, the best point so far, and how far faces must be solved for that.
    template <typename Vector>
    class StoppingTest
    {
    public:
      struct Best
      {
        PointWithGradient<Vector> point;
        double                    residual; // over the reference
      };

      /// All but the goal is referred to. @param norm_ |PFP|
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

      /// Residual that faces are solved to, over the reference: the goal's, or less until its point is right.
      double tolerance_of_faces() const
      {
        return tolerance;
      }

      /// Was the goal met at a point that was not right?
      bool has_met_goal() const
      {
        return is_met;
      }

      /// Is this point, which meets the goal, the solution? Else it is kept as the best, and faces are solved to less from now
      /// on.
      /// @param residual of the face, @param left of everything, over the reference. @param size of forces at that point.
      /// @param error returns its estimated error
      template <typename Error>
      bool accepts(const PointWithGradient<Vector> &at,
                   const double                     residual,
                   const double                     left,
                   const double                     size,
                   const Error                     &error)
      {
        best = Best{at, residual};
        if (left <= options.least_part * goal.tolerance ||
            (tells_forces(left, size) && (!is_right || is_right(at.x, error()))))
          return true;
        is_met    = true;
        tolerance = options.tightening * left;
        return false;
      }

      /// After a face that was solved to @p residual and ended with this natural residual, both over the reference: faces
      /// may meet the goal on sets whose bounds are violated by far more than before. Where that happens again, sets are told
      /// by gradients below the goal (compliances that are far apart), and faces are solved to less.
      void check_start_of_face(const double residual, const double natural_residual)
      {
        if (residual <= goal.tolerance &&
            natural_residual > options.astray * std::max(goal.tolerance, last_natural_residual) && ++n_astray > 1)
          tolerance = std::min(tolerance, options.tightening * residual);
        last_natural_residual = natural_residual;
      }

      /// The natural residual is the least so far.
      void propose(const PointWithGradient<Vector> &at, const double residual)
      {
        if (!is_met)
          best = Best{at, residual};
      }

      /// Where the natural residual is least, or where the goal was met last.
      std::optional<Best> take_best()
      {
        return std::exchange(best, std::nullopt);
      }

    private:
      // Where gaps of open contact make the reference, the forces may be next to nothing beside it.
      bool tells_forces(const double left, const double size) const
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
      double              last_natural_residual = std::numeric_limits<double>::infinity();
      unsigned int        n_astray              = 0;
    };
  } // namespace detail
} // namespace slipstick::qp
