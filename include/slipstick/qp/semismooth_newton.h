// Semismooth Newton method for the natural residual of bounds and equalities, with a line search on its norm.
//
// The solution satisfies x = proj(x - s g), g = F x - d + G'a, G x = e, on the entries with bounds, and g = 0 on the
// others (Hintermueller, Ito, Kunisch 2003; bounds that follow the solution, Coulomb friction: Alart, Curnier 1991). A
// Newton step solves the linear problem of the face that the projection determines: entries at bounds are held there,
// slipping ones are tied to their normal force. F x is known at both ends of a step, so that the norm of the residual
// along the step costs no multiplication: the line search takes vector operations only.
//
// In addition to the members of the Problem of types.h it needs
//   `auto face(const std::vector<bool> &free, const std::vector<Tie> &ties, const std::vector<Turn> &turns) const`
//       the problem on the free (owned) entries, with others tied to them; entries of nodes that slip in space are
//       meant as turned (pressure_bounds.h; vectors are not turned). It has multiply and reduction as the Problem, and
//       `project_range(x, y)`   y = Q_f x on the free entries, y = x on the others, so that P_f = I - Q_f keeps G x
//       `balance(x)`            makes G x = e by the smallest change of the free entries (the tied ones follow)
//       `project_kernel(p)`     the same for G p = 0; then sets the tied entries to factor times the free ones
//       `clear_held(p)`         p = 0 on the entries that are neither free nor tied
//       `multiplier_shift(v, y)` y = G'a on ALL entries, with the a that minimises v - G'a on the free ones
//       `precondition(r, z)`    z = M r on the free entries, 0 on the others; symmetric positive semidefinite
//       `is_regular()`          false if the free entries alone do not determine a
//       the Problem and its faces may have residual_weights (kernels.h)
//   `loose_bodies() const`   an object with
//       `hold(free, gaps, well, turns)`   the free entries and as many others, with small gaps, as make the face
//           regular, if possible; with `well`, far from singular
//       and, if there are bodies that are held by entries with bounds only,
//       `predict_active_sets()` whether it is worthwhile to move them
//       `balance(stiffness, set, tolerated, moved)`   moves them, moved -= stiffness times their jumps, such that
//           proj(moved) balances their loads up to the part `tolerated` of all forces (the minimum of the potential of
//           the projected forces). The predicted sets can then carry the loads.
// It may have `point_stiffness() const`, |PFP| times the stiffness of an entry of weight 1 among yielding neighbours
// (active_set.h), and, like its faces, `dependent_compliances() const` (kernels.h).
#pragma once

#include <slipstick/qp/active_set.h>
#include <slipstick/qp/globalization.h>
#include <slipstick/qp/newton_faces.h>
#include <slipstick/qp/newton_point.h>
#include <slipstick/qp/stopping_test.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <memory>
#include <optional>
#include <vector>

namespace slipstick::qp
{
  /// The point that determines the first active set: entries at their bounds or, given the gradient F x - d + G'a,
  /// those that a step along it moves there.
  template <typename Vector>
  struct NewtonStart
  {
    Vector                x;
    std::optional<Vector> gradient = std::nullopt;

    /// Directions of earlier solves with the same F and G, to which this solve adds its own; null: none.
    std::shared_ptr<DirectionStore<Vector>> directions = nullptr;

    /// Whether the start is far from the solution. If so, the first set is predicted again where the start is balanced.
    bool is_rough = false;
  };

  /// Ends the method before its goal is reached. Called after every step with x on its bounds and its gradient F x - d
  /// + G'a; must return the same on every process.
  template <typename Vector>
  using Acceptance = std::function<bool(const Vector &x, const Vector &gradient)>;

  template <typename Vector>
  struct NewtonResult
  {
    Status            status;
    Vector            x;                  // when converged: free entries within their bounds, the others at them
    std::vector<bool> free;               // owned entries
    double            projected_gradient; // |gP| over the reference of the goal
    Vector gradient; // F x - d + G'a, before x was put on its bounds; predicts the first set of a similar problem
    Counts counts;
  };

  namespace detail
  {
    template <typename Vector, typename Problem>
    class SemismoothNewton
    {
    public:
      SemismoothNewton(const Problem            &problem_,
                       const double              norm_,
                       const Vector             &d_,
                       AdmissibleSet<Vector>     admissible,
                       NewtonStart<Vector>       start,
                       const Goal               &goal_,
                       const NewtonOptions      &options_,
                       const Observer           &observer_,
                       const Acceptance<Vector> &accepts_,
                       const ErrorTest<Vector>  &is_right_)
        : problem(problem_)
        , norm(norm_)
        , d(d_)
        , goal(goal_)
        , options(options_)
        , observer(observer_)
        , accepts(accepts_)
        , stop(goal_, norm_, options_, is_right_)
        , set(problem_, norm_, std::move(admissible), options.set_step, noise_of(problem_, d_))
        , now(std::move(start.x), start.gradient ? std::move(*start.gradient) : zero_like(d_), zero_like(d_))
        , next(zero_like(d_), zero_like(d_), zero_like(d_))
        , faces(problem_, norm_, d_, goal, options_, std::move(start.directions), set, counts)
        , path(problem_, options_, goal.reference, start.is_rough, set, stop, now, next)
      {
        set.predict(now.x, now.gradient);
      }

      NewtonResult<Vector> run()
      {
        const Status status = iterate();
        if (status != Status::converged && go_to_best())
          set.predict(now.x, zero_like(now.x));
        set.put_on_bounds(now.x); // makes ties exact to the last bit
        set.project_on_bounds(now.x);
        return {status, std::move(now.x), set.free(), residual, std::move(now.gradient), counts};
      }

    private:
      using Face = typename NewtonFaces<Vector, Problem>::Face;

      // Rounding level of gradients, which are differences of entries of d and F x.
      static double noise_of(const Problem &problem, const Vector &d)
      {
        constexpr double rounding = 4 * std::numeric_limits<double>::epsilon();
        double           largest  = 0;
        for (const double value : d)
          largest = std::max(largest, std::abs(value));
        return -rounding * problem.reduction().min(-largest);
      }

      Status iterate()
      {
        if (!begin())
          return Status::infeasible;
        while (counts.outer_iterations < options.max_outer_iterations)
          {
            const auto face = faces.regular(path.is_stuck());
            if (!face)
              return Status::infeasible;
            if (path.may_be_solution() && solves_already(*face))
              return converged_at_next();
            faces.solve(*face, path.merit(), stop.tolerance_of_faces(), now, next);
            ++counts.outer_iterations;
            const double left = measure();
            report();
            if (!std::isfinite(residual))
              return Status::stagnated;
            if (is_accepted() || is_solution(*face, left))
              return converged_at_next();
            stop.check_start_of_face(residual, left);
            if (!path.step())
              return ended(Status::stagnated);
          }
        return ended(Status::iteration_limit);
      }

      // Computes the residual of `next`. @return its sum with the violation of the bounds, over the reference.
      double measure()
      {
        const auto [gradient, violation] = set.residuals(next.x, next.gradient);
        residual                         = gradient / goal.reference;
        return residual + violation / goal.reference;
      }

      // A point that was not found on a face may be the solution: the start, if the loads hardly differ from the
      // previous ones, or the end of a step that was cut. A step on a nearly singular face could lead far away from it.
      bool solves_already(const Face &face)
      {
        if (!(path.merit() <= goal.tolerance * goal.reference))
          return false;
        next = now;
        faces.fill_gradient(face, next);
        const double left = measure();
        if (!is_solution(face, left))
          return false;
        report();
        return true;
      }

      // Whether `next`, with this residual, is the solution. It is either the present point or the solution on the
      // face.
      bool is_solution(const Face &face, double left)
      {
        if (left <= goal.tolerance && next.error_of_Fx > options.face.accuracy * goal.tolerance * goal.reference)
          {
            faces.multiply(face, next);
            left = measure();
          }
        if (left <= goal.tolerance)
          left += imbalance(face);
        return left <= goal.tolerance &&
               stop.accepts(next, residual, left, size_of_forces(next.x), [&] { return error_on(face); });
      }

      Status converged_at_next()
      {
        std::swap(now, next);
        return Status::converged;
      }

      // The norm of the forces, or the scale given by the goal if that is larger: what remains of larger forces, for
      // instance after unloading, is small beside these.
      double size_of_forces(const Vector &forces) const
      {
        return std::max(std::isfinite(goal.forces) ? goal.forces : 0., qp::norm(forces, problem.reduction()));
      }

      // Residuals that are below the goal and no longer decrease are at rounding level.
      Status ended(const Status status)
      {
        if (!stop.has_met_goal())
          return status;
        go_to_best();
        set.predict(now.x, now.gradient);
        return Status::converged;
      }

      // @return whether there is one.
      bool go_to_best()
      {
        auto best = stop.take_best();
        if (!best)
          return false;
        static_cast<PointWithGradient<Vector> &>(now) = std::move(best->point);
        residual                                      = best->residual;
        return true;
      }

      // The change of `next`, put on its bounds, that G x = e requires: relative to the reference or to its own size,
      // whichever gives more. The latter does if gaps determine the reference and the forces are negligible beside it.
      double imbalance(const Face &face)
      {
        Vector at = next.x;
        set.put_on_bounds(at);
        Vector balanced = at;
        face.balance(balanced);
        const double size = size_of_forces(balanced);
        add(-1., at, balanced);
        const double missing = qp::norm(balanced, problem.reduction());
        return missing > 0 ? missing * std::max(norm / goal.reference, 1 / size) : 0.;
      }

      // M r on the free entries, and the distances of the others from their bounds: nearly the error of `next`.
      Vector error_on(const Face &face)
      {
        Vector r(next.gradient), error(r);
        combine(-1., next.gradient, 0., r);
        face.precondition(static_cast<const Vector &>(r), error);
        ++counts.preconditioner_applications;
        face.project_kernel(error);
        Vector at = next.x;
        set.put_on_bounds(at);
        set.project_on_bounds(at);
        for (std::size_t i = 0; i < local_size(at); ++i)
          error.begin()[i] += at.begin()[i] - next.x.begin()[i];
        return error;
      }

      // Moves the start to its bounds and to G x = e; computes F x, the gradient and the set.
      bool begin()
      {
        const auto face = faces.regular(false);
        if (!face)
          return false;
        set.put_on_bounds(now.x);
        face->balance(now.x);
        faces.multiply(*face, now);
        path.begin();
        return true;
      }

      bool is_accepted()
      {
        if (!accepts)
          return false;
        Vector at = next.x;
        set.put_on_bounds(at);
        return accepts(at, next.gradient);
      }

      void report() const
      {
        if (!observer)
          return;
        const auto n = set.count();
        observer({counts.outer_iterations,
                  counts.hessian_multiplications,
                  residual,
                  0.0,
                  static_cast<std::size_t>(n[0]),
                  static_cast<std::size_t>(n[1])});
      }

      const Problem            &problem;
      const double              norm;
      const Vector             &d;
      const Goal                goal;
      const NewtonOptions      &options;
      const Observer           &observer;
      const Acceptance<Vector> &accepts;

      StoppingTest<Vector>           stop;
      ActiveSet<Vector, Problem>     set;
      NewtonPoint<Vector>            now;                 // present point
      NewtonPoint<Vector>            next;                // end of the present step
      double                         residual = HUGE_VAL; // of the last face, over the reference
      Counts                         counts;
      NewtonFaces<Vector, Problem>   faces;
      Globalization<Vector, Problem> path;
    };
  } // namespace detail

  /// Minimises 1/2 x'Fx - x'd over the admissible set and G x = e; with bounds that follow the solution, finds the
  /// equilibrium instead of the minimum. `norm` is |PFP|; goal.reference must be given (|P(d - F x~)|).
  /// status: converged if @p accepts returned true, or if x is within its bounds, |gP| and |PFP| |G x - e| are at most
  /// goal.tolerance times goal.reference, and @p is_right returned true or the residual cannot be reduced further;
  /// infeasible if the equalities remain singular when entries leave their bounds; stagnated if the natural residual
  /// does not decrease along a step.
  /// @code
  /// using namespace test; // FacedProblem: a dense problem with faces, tests/qp/faced_problem.h
  /// Matrix G(1, 2);
  /// G(0, 0) = G(0, 1) = std::sqrt(0.5);
  /// const FacedProblem          problem(diagonal({1, 1}), G, {0});
  /// const AdmissibleSet<Vector> set{{{-0.25, -infinity}, {0.25, infinity}}, {}};
  /// const auto best = semismooth_newton(problem, 1., Vector{1, -1}, set, NewtonStart<Vector>{Vector(2, 0.)}, Goal(1e-10, 1.));
  /// assert(best.status == Status::converged);
  /// assert(std::abs(best.x[0] - 0.25) < 1e-9 && std::abs(best.x[1] + 0.25) < 1e-9); // 1, -1 without bounds
  /// @endcode
  template <typename Vector, typename Problem>
  NewtonResult<Vector> semismooth_newton(const Problem            &problem,
                                         const double              norm,
                                         const Vector             &d,
                                         AdmissibleSet<Vector>     admissible,
                                         NewtonStart<Vector>       start,
                                         const Goal               &goal,
                                         const NewtonOptions      &options  = {},
                                         const Observer           &observer = {},
                                         const Acceptance<Vector> &accepts  = {},
                                         const ErrorTest<Vector>  &is_right = {})
  {
    return detail::SemismoothNewton<Vector, Problem>(problem,
                                                     norm,
                                                     d,
                                                     std::move(admissible),
                                                     std::move(start),
                                                     goal,
                                                     options,
                                                     observer,
                                                     accepts,
                                                     is_right)
      .run();
  }
} // namespace slipstick::qp
