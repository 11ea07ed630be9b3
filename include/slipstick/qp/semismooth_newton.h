// Semismooth Newton method for the natural residual of bounds and equalities, with a line search on its norm.
//
// The solution satisfies x = proj(x - s g), g = F x - d + G'a, G x = e, on the entries with bounds, and g = 0 on the
// others (Hintermueller, Ito, Kunisch 2003; bounds that follow the solution, Coulomb friction: Alart, Curnier 1991). A
// Newton step solves the linear problem of the face that the projection determines: entries at bounds are held there,
// slipping ones are tied to their normal force. F x is known at both ends of a step, so that the norm of the residual
// along the step costs no multiplication: the line search (nonmonotone: Grippo, Lampariello, Lucidi 1986) takes vector
// operations only.
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
// It may have `point_stiffness() const`, |PFP| times the stiffness of an entry of weight 1 whose neighbours are held
// (active_set.h), and, like its faces, `dependent_compliances() const` (kernels.h).
#pragma once

#include <slipstick/qp/active_set.h>
#include <slipstick/qp/face_solver.h>
#include <slipstick/qp/line_search.h>
#include <slipstick/qp/newton_point.h>
#include <slipstick/qp/set_history.h>
#include <slipstick/qp/stopping_test.h>
#include <slipstick/qp/watchdog.h>

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

    /// Whether the start is far from the solution. If so, one step may raise the residual.
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
    // Length of a step along M r: eigenvalues of F M are 1 to about 5 (first steps of conjugate gradients: 0.15 to
    // 0.5).
    constexpr double descent_step = 0.3;
    // Largest number of kinks of the natural residual that are crossed from one point.
    constexpr std::size_t most_kinks = 10;

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
        , has_wide_stiffnesses(ratio_of_weights(problem_, d_) > options_.wide_stiffnesses)
        , is_singular(dependent_compliances(problem_, 0) != nullptr)
        , stop(goal_, norm_, options_, is_right_)
        , set(problem_, norm_, std::move(admissible), options.set_step, noise_of(problem_, d_))
        , directions(start.directions ? std::move(start.directions)
                                      : std::make_shared<DirectionStore<Vector>>(options_.n_directions))
        , store(*directions)
        , line(options_)
        , watchdog(options_)
        , solved(options.n_remembered_sets)
        , refused(most_kinks + 1)
        , now(std::move(start.x), start.gradient ? std::move(*start.gradient) : zero_like(d_), zero_like(d_))
        , next(zero_like(d_), zero_like(d_), zero_like(d_))
        , is_rough(start.is_rough)
        , told(zero_like(d_))
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
      using Face = decltype(std::declval<Problem>().face(std::vector<bool>(), std::vector<Tie>(), std::vector<Turn>()));

      // The largest weight of a residual over the smallest, which is 1.
      static double ratio_of_weights(const Problem &problem, const Vector &d)
      {
        const double *weights = residual_weights(problem, 0);
        double        largest = 1;
        for (std::size_t i = 0; weights && i < local_size(d); ++i)
          largest = std::max(largest, weights[i]);
        return -problem.reduction().min(-largest);
      }

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
        is_unjudged = !is_rough;
        while (counts.outer_iterations < options.max_outer_iterations)
          {
            const auto face = regular_face();
            if (!face)
              return Status::infeasible;
            if (is_unjudged && solves_already(*face))
              return converged_at_next();
            solve(*face);
            ++counts.outer_iterations;
            const double left = measure();
            report();
            if (!std::isfinite(residual))
              return Status::stagnated;
            if (is_accepted() || is_solution(*face, left))
              return converged_at_next();
            stop.check_start_of_face(residual, left);
            if (!step())
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
        if (!(line.present() <= goal.tolerance * goal.reference))
          return false;
        next.x  = now.x;
        next.Fx = now.Fx;
        fill_gradient(face, next);
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

      // The face of the set. If it leaves a motion open, the entries at bounds that are closest to leaving them hold
      // it; after a failed step, motions that the free entries hardly resist count as open.
      std::optional<Face> regular_face()
      {
        if (is_stuck)
          set.release(problem.loose_bodies().hold(set.free(), set.gaps(), true, set.turns()));
        for (unsigned int attempt = 0; attempt < 2; ++attempt)
          {
            ties = set.ties();
            std::optional<Face> face;
            face.emplace(problem.face(set.free(), ties, set.turns()));
            if (face->is_regular())
              return face;
            set.release(problem.loose_bodies().hold(set.free(), set.gaps(), false, set.turns()));
          }
        return {};
      }

      // Moves the start to its bounds and to G x = e; computes F x, the gradient and the set.
      bool begin()
      {
        auto face = regular_face();
        if (!face)
          return false;
        set.put_on_bounds(now.x);
        face->balance(now.x);
        problem.multiply(now.x, now.Fx);
        ++counts.hessian_multiplications;
        fill_gradient(*face, now);
        line.begin(set.natural_residual(now.x, now.gradient));
        predict(now);
        return true;
      }

      // Sets the active set to the one predicted from a point and its gradient.
      void predict(const PointWithGradient<Vector> &at)
      {
        predict(at.x, at.gradient);
      }

      // Natural residuals with different s cannot be compared. Those of the last steps are therefore scaled by the
      // factor by which the residual of the present point changes with s.
      void predict(const Vector &at, const Vector &gradient)
      {
        const double before = set.step_length();
        told                = gradient;
        set.predict(at, gradient);
        if (set.step_length() == before || !(line.present() > 0))
          return;
        const double factor = set.natural_residual(now.x, now.gradient) / line.present();
        line.rescale(factor);
        watchdog.rescale(factor);
      }

      // F x - d + G'a, with the a that minimises it on the free entries, including the gradient of turned forces.
      void fill_gradient(const Face &face, NewtonPoint<Vector> &at) const
      {
        combine(1.0, at.Fx, 0.0, at.gradient);
        add(-1.0, d, at.gradient);
        Vector shift(at.gradient), left(at.gradient);
        add_compliance(set.turns(), at.x, left);
        face.multiplier_shift(static_cast<const Vector &>(left), shift);
        add(-1.0, shift, at.gradient);
      }

      // Regularisation of the next face, which decreases with the residual (Levenberg, Marquardt): where forces are not
      // unique, the method converges to the nearest ones, as fast as elsewhere (Fan, Yuan 2005). The residual that a
      // face leaves, divided by this, is the distance by which forces may drift that F does not determine.
      double regularization() const
      {
        return is_singular ? std::min(options.largest_regularization, line.present() / goal.reference) : 0.;
      }

      // `next` becomes the solution on the face, up to a part of the present residual.
      void solve(const Face &face)
      {
        next.x = now.x;
        set.put_on_bounds(next.x);
        face.balance(next.x);
        const Vector center(next.x);
        step_to_start(face);
        FaceSolver<Vector, Face> solver(
          face,
          d,
          store,
          [this](const Vector &p) { return set.conditions(p, ties); },
          options.face,
          set.turns(),
          regularization());
        const double first  = solver.start(std::move(next.x), std::move(next.Fx), now.error_of_Fx, center);
        const double target = std::min(std::max(options.last_forcing * stop.tolerance_of_faces() * goal.reference,
                                                (is_singular ? options.singular_forcing : options.forcing) *
                                                  std::min(first, line.present())),
                                       options.sharpening * solved.least_of_earlier(set.sides(), problem.reduction()));
        auto         result = has_ties() ? solver.solve_unsymmetric(target) : solver.solve_symmetric(target);
        if (is_singular || has_wide_stiffnesses)
          solved.add(set.sides(), result.residual);
        counts += result.counts;
        next.x           = std::move(result.x);
        next.Fx          = std::move(result.product);
        next.error_of_Fx = result.error;
        restore_balance(face);
        fill_gradient(face, next);
      }

      // Directions satisfy G p = 0 up to rounding, and so do their combinations unless they cancel. What is missing of G
      // x = e is restored; otherwise it would grow from face to face, since steps between points become directions.
      void restore_balance(const Face &face)
      {
        Vector balanced(next.x), product(next.x);
        face.balance(balanced);
        add(-1., next.x, balanced);
        const double missing = qp::norm(balanced, problem.reduction());
        if (!(missing > force_rounding * qp::norm(next.x, problem.reduction())))
          return;
        add(1., balanced, next.x);
        if (norm * missing <= options.face.accuracy * options.last_forcing * stop.tolerance_of_faces() * goal.reference)
          {
            next.error_of_Fx = std::hypot(next.error_of_Fx, norm * missing);
            return;
          }
        problem.multiply(balanced, product);
        ++counts.hessian_multiplications;
        add(1., product, next.Fx);
      }

      // Whether any process has ties.
      bool has_ties() const
      {
        return problem.reduction().min(ties.empty() ? 1. : 0.) < 1;
      }

      // F x of `next`, from the product with the step to it, which is stored as a direction. Steps at rounding level
      // are ignored.
      void step_to_start(const Face &face)
      {
        constexpr double no_direction = 1e-6; // relative to |x|
        Vector           step(next.x), product(next.x);
        add(-1., now.x, step);
        const auto s =
          problem.reduction().sum(std::array<double, 2>{{local_dot(step, step), local_dot(next.x, next.x)}});
        std::copy(now.Fx.begin(), now.Fx.end(), next.Fx.begin());
        if (s[0] <= force_rounding * force_rounding * s[1])
          return;
        descend(face, step);
        std::copy(now.x.begin(), now.x.end(), next.x.begin());
        add(1., step, next.x);
        problem.multiply(step, product);
        ++counts.hessian_multiplications;
        add(1., product, next.Fx);
        if (s[0] > no_direction * no_direction * s[1]) // otherwise G step = 0 holds only to a few digits
          {
            const double squares = problem.reduction().sum(
              std::array<double, 1>{{local_squares(residual_weights(problem, 0), step, product)}})[0];
            store.push(std::move(step),
                       std::move(product),
                       rounding_of_product(squares),
                       dependent_compliances(problem, 0),
                       problem.reduction());
          }
      }

      // Adds a short step along the preconditioned residual of the face to the step onto its bounds: F is multiplied
      // anyway.
      void descend(const Face &face, Vector &step)
      {
        Vector r(now.gradient), shift(r), p(r);
        add_compliance(set.turns(), now.x, r);
        face.multiplier_shift(static_cast<const Vector &>(r), shift);
        add(-1., shift, r);
        combine(-1., r, 0., r);
        face.precondition(static_cast<const Vector &>(r), p);
        ++counts.preconditioner_applications;
        face.project_kernel(p);
        add(descent_step, p, step);
      }

      // Moves along the step to the next point and set. @return whether there is one.
      bool step()
      {
        double t    = line.search(set, now, next);
        is_unjudged = false;
        if (watchdog.is_watching())
          {
            if (watchdog.goes_on(line))
              {
                go_whole();
                return true;
              }
            t = come_back();
          }
        else if (t < options.shortest_step && !stop.has_met_goal() && watchdog.may_begin(line))
          {
            watchdog.begin({now, next, told, line, t});
            go_whole();
            return true;
          }
        if (t < options.shortest_step)
          {
            if (stop.has_met_goal())
              return false;
            if (cross_kink() || restart() || leap())
              return true;
            if (t == 0)
              return false;
          }
        move_by_part(t);
        is_unjudged = t < 1;
        is_stuck    = false;
        refused.clear();
        if (t < options.shortest_step)
          predict(line.refused());
        else
          predict_from_here(t == 1);
        return true;
      }

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
        const bool is_changed = set.balance_finely() || set.soften(), is_first = !is_stuck;
        is_stuck = true;
        if (is_changed)
          line.begin(set.natural_residual(now.x, now.gradient));
        predict(now);
        return is_changed || is_first;
      }

      // Once, from a rough start, takes the whole step although it raises the residual. @return whether it was taken.
      bool leap()
      {
        if (!is_rough || !(line.whole() <= options.longest_leap * line.present()))
          return false;
        is_rough = false;
        go_whole();
        return true;
      }

      // Returns to the point where whole steps began. @return the part of the step from there that is taken.
      double come_back()
      {
        auto start = watchdog.give_up();
        now        = std::move(start.from);
        next       = std::move(start.to);
        line       = std::move(start.line);
        predict(now.x, start.told);
        return start.t;
      }

      void go_whole()
      {
        go_to_next(line.whole());
        is_stuck = false;
        refused.clear();
        predict_from_here(true);
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
        if (line.found() < line.least())
          stop.propose(next, line.found() / goal.reference);
        if (!(line.found() < line.present()) && (t == 1 || !set.balance_finely()))
          set.soften();
        go_to_next(line.found());
      }

      void go_to_next(const double merit)
      {
        line.move_to(merit);
        set.approach(merit / goal.reference);
        std::swap(now, next);
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
      const bool                has_wide_stiffnesses; // sets may depend on gradients below the tolerance
      const bool                is_singular;          // whether F is singular on some faces

      StoppingTest<Vector>                           stop;
      ActiveSet<Vector, Problem>                     set;
      const std::shared_ptr<DirectionStore<Vector>>  directions;
      DirectionStore<Vector>                        &store;
      std::vector<Tie>                               ties; // of the present face
      LineSearch<Vector, ActiveSet<Vector, Problem>> line;
      Watchdog<Vector, ActiveSet<Vector, Problem>>   watchdog;
      SetHistory                                     solved; // with the residuals to which faces were solved
      SetHistory refused; // sets whose steps do not lower the residual of the present point

      NewtonPoint<Vector> now;                    // present point
      NewtonPoint<Vector> next;                   // end of the present step
      bool                is_unjudged = false;    // whether `now` may be the solution
      double              residual    = HUGE_VAL; // of the last face, over the reference
      bool                is_stuck    = false;    // the last step did not lower the natural residual
      bool                is_rough; // whether the start is, and no step has raised the residual deliberately yet
      Vector              told;     // gradient of the last prediction
      Counts              counts;
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
