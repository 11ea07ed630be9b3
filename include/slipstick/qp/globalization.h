// Steps of the semismooth Newton method that reduce the natural residual from any start: line search, sets
// beyond kinks, restarts.
#pragma once

#include <slipstick/qp/active_set.h>
#include <slipstick/qp/kernels.h>
#include <slipstick/qp/line_search.h>
#include <slipstick/qp/newton_point.h>
#include <slipstick/qp/options.h>
#include <slipstick/qp/set_history.h>
#include <slipstick/qp/stopping_test.h>

#include <algorithm>
#include <cmath>
#include <utility>

namespace slipstick::qp::detail
{
  // Largest number of kinks of the natural residual that are crossed from one point.
  constexpr std::size_t most_kinks = 10;

  /// Moves the present point along steps to solutions of faces, and predicts the next set there.
  template <typename Vector, typename Problem>
  class Globalization
  {
  public:
    using Point = NewtonPoint<Vector>;

    /// @param set, stop, now, next are changed; all are kept by reference. @param reference of residuals.
    /// @param is_rough_ NewtonStart::is_rough
    Globalization(const Problem              &problem_,
                  const NewtonOptions        &options_,
                  const double                reference_,
                  const bool                  is_rough_,
                  ActiveSet<Vector, Problem> &set_,
                  StoppingTest<Vector>       &stop_,
                  Point                      &now_,
                  Point                      &next_)
      : problem(problem_)
      , options(options_)
      , reference(reference_)
      , set(set_)
      , stop(stop_)
      , now(now_)
      , next(next_)
      , line(options_)
      , refused(most_kinks + 1)
      , is_rough(is_rough_)
      , is_candidate(!is_rough_)
    {}

    /// Starts from a point whose gradient is known. The present set, which was predicted from the start, is kept unless
    /// the start is rough: at the end of a load step the set is the right one, and if loads grow in proportion, it remains
    /// so, while the gradient with the new loads predicts another.
    void begin()
    {
      line.begin(set.natural_residual(now.x, now.gradient));
      if (is_rough)
        predict(now);
    }

    /// Natural residual of the present point.
    double merit() const
    {
      return line.present();
    }

    /// Whether the present point may be the solution although it was not found on a face.
    bool may_be_solution() const
    {
      return is_candidate;
    }

    /// Whether the last step did not lower the natural residual.
    bool is_stuck() const
    {
      return stuck;
    }

    /// Moves along the step to the next point and set. @return whether there is one.
    bool step()
    {
      const double t = line.search(set, now, next);
      is_candidate   = false;
      if (t < options.shortest_step)
        {
          if (stop.has_met_goal())
            return false;
          if (cross_kink() || restart())
            return true;
          if (t == 0)
            return false;
        }
      move_by_part(t);
      is_candidate = t < 1;
      stuck        = false;
      refused.clear();
      if (t < options.shortest_step)
        predict(line.refused());
      else
        predict_from_here(t == 1);
      return true;
    }

  private:
    // The natural residual has a kink next to the present point, where entries reach or leave their bounds. The
    // derivative along the step determines the set beyond it (Pang 1990); the step of that set may cross other kinks.
    // @return whether that set was not tried from here yet.
    bool cross_kink()
    {
      refused.add(set.sides());
      if (refused.size() > most_kinks)
        return false;
      predict(line.refused());
      return !refused.contains(set.sides(), problem.reduction());
    }

    // Restarts from the set of the present point, with bodies balanced finely or, if they are already, on softer
    // points. @return whether this was not tried yet.
    bool restart()
    {
      const bool is_changed = set.balance_finely() || set.soften(), is_first = !stuck;
      stuck = true;
      if (is_changed)
        line.begin(set.natural_residual(now.x, now.gradient));
      predict(now);
      return is_changed || is_first;
    }

    // @param is_solved whether this is the end of a whole step, so that the gradient on the free entries is
    // meaningless
    void predict_from_here(const bool is_solved)
    {
      Vector known(now.gradient);
      if (is_solved)
        set.clear_solved(now.x, known);
      predict(now.x, known);
    }

    // Moves to the end of the step found by the line search.
    void move_by_part(const double t)
    {
      if (t < 1)
        {
          std::swap(static_cast<PointWithGradient<Vector> &>(next), line.end());
          combine(1 - t, now.Fx, t, next.Fx);
          next.error_of_Fx = std::max(now.error_of_Fx, next.error_of_Fx);
        }
      stop.propose(next, line.found() / reference);
      line.begin(line.found());
      set.approach(line.found() / reference);
      std::swap(now, next);
    }

    // Sets the active set to the one predicted from a point and its gradient.
    void predict(const PointWithGradient<Vector> &at)
    {
      predict(at.x, at.gradient);
    }

    // Natural residuals with different s cannot be compared.
    void predict(const Vector &at, const Vector &gradient)
    {
      const double before = set.step_length();
      set.predict(at, gradient);
      if (set.step_length() != before)
        line.begin(set.natural_residual(now.x, now.gradient));
    }

    const Problem              &problem;
    const NewtonOptions        &options;
    const double                reference;
    ActiveSet<Vector, Problem> &set;
    StoppingTest<Vector>       &stop;
    Point                      &now;  // present point
    Point                      &next; // end of the present step

    LineSearch<Vector, ActiveSet<Vector, Problem>> line;
    SetHistory refused;       // sets whose steps do not lower the residual of the present point
    bool       is_rough;      // NewtonStart::is_rough
    bool       is_candidate;  // may_be_solution()
    bool       stuck = false; // is_stuck()
  };
} // namespace slipstick::qp::detail
