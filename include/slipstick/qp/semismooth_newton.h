// Semismooth Newton on the natural residual of bounds and equalities, with a line search on its norm.
//
// The solution is where x = proj(x - s g), g = F x - d + G'a, G x = e, on the entries with bounds, and g = 0 on the others
// (Hintermueller, Ito, Kunisch 2003; bounds that follow the solution, Coulomb friction: Alart, Curnier 1991). A Newton step
// solves the linear problem of the face that the projection tells: entries at bounds held there, slipping ones tied to
// their normal force. F x is known at both ends of a step, so the norm of the residual is known along it without a
// multiplication: the line search (nonmonotone: Grippo, Lampariello, Lucidi 1986) costs vector operations only.
//
// Besides the Problem of types.h it needs
//   `auto face(const std::vector<bool> &free, const std::vector<Tie> &ties, const std::vector<Turn> &turns) const`
//       the problem on the free entries (owned ones) with others tied to them, where entries of nodes that slip in space count
//       as turned (pressure_bounds.h; vectors are not turned), which has multiply, reduction as the Problem, and
//       `project_range(x, y)`   y = Q_f x on the free entries, y = x on the others, so that P_f = I - Q_f keeps G x
//       `balance(x)`            moves the free entries (the tied ones with them) by the least that makes G x = e
//       `project_kernel(p)`     the same for G p = 0; then sets the tied entries to factor times theirs
//       `multiplier_shift(v, y)` y = G'a on ALL entries, with a such that v - G'a is least on the free ones
//       `precondition(r, z)`    z = M r on the free entries, 0 on the others; symmetric positive semidefinite
//       the Problem and its faces may have residual_weights (kernels.h)
//       `is_regular()`          false when the free entries alone do not determine a
//   `loose_bodies() const`   an object with
//       `hold(free, gaps, well, turns)`   the free entries and as many others, with small gaps, as make the face regular if
//           that can be; or, if that is asked for, far from singular
//       and, if there are bodies that nothing but entries with bounds holds,
//       `predict_active_sets()` is it worth while to move them?
//       `balance(stiffness, set, tolerated, moved)`   moves them, moved -= stiffness times their jumps, so that proj(moved)
//           balances their loads, up to the part `tolerated` of all forces: the least of the potential of the projected
//           forces. So sets are predicted that can bear the loads.
// It may have `point_stiffness() const`, |PFP| times the stiffness of an entry of weight 1 whose neighbours are held (active_set.h),
// and, as its faces, `dependent_compliances() const` (kernels.h).
#pragma once

#include <slipstick/qp/active_set.h>
#include <slipstick/qp/face_solver.h>
#include <slipstick/qp/line_search.h>
#include <slipstick/qp/set_history.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <optional>
#include <vector>

namespace slipstick::qp
{
  /// The point that tells the first active set: entries at their bounds, or, with the gradient F x - d + G'a, those that
  /// a step along it takes there.
  template <typename Vector>
  struct NewtonStart
  {
    Vector                x;
    std::optional<Vector> gradient = std::nullopt;

    /// Directions of earlier solves with the same F and G, and where this one leaves its own; none: its own.
    std::shared_ptr<DirectionStore<Vector>> directions = nullptr;

    /// Far from the solution? Then a step may once raise the residual.
    bool is_rough = false;
  };

  /// Ends the method before its goal is reached: called with x on its bounds and its gradient F x - d + G'a after every
  /// step, on every process with the same result.
  template <typename Vector>
  using Acceptance = std::function<bool(const Vector &x, const Vector &gradient)>;

  /// Is the estimated error of x, M r of the face, small where it counts? Asked once the goal is reached; else the method
  /// goes on to smaller residuals. On every process with the same result.
  template <typename Vector>
  using ErrorTest = std::function<bool(const Vector &x, const Vector &error)>;

  template <typename Vector>
  struct NewtonResult
  {
    Status            status;
    Vector            x;                  // free entries within their bounds when converged, the others at them
    std::vector<bool> free;               // owned entries
    double            projected_gradient; // |gP| over the reference of the goal
    Vector gradient; // F x - d + G'a, before x was put on its bounds: tells the first set of a similar problem
    Counts counts;
  };

  namespace detail
  {
    // Of a step along M r: eigenvalues of F M are 1 to some 5 (first steps of conjugate gradients there: 0.15 to 0.5).
    constexpr double descent_step = 0.3;
    // So many kinks of the natural residual are crossed from one point.
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
        , is_right(is_right_)
        , has_wide_stiffnesses(ratio_of_weights(problem_, d_) > options_.wide_stiffnesses)
        , is_singular(dependent_compliances(problem_, 0) != nullptr)
        , tolerance(goal_.tolerance)
        , set(problem_, norm_, std::move(admissible), options.set_step, noise_of(problem_, d_))
        , directions(start.directions ? std::move(start.directions)
                                      : std::make_shared<DirectionStore<Vector>>(options_.n_directions))
        , store(*directions)
        , line(options_)
        , solved(options_.n_remembered_sets)
        , refused(most_kinks + 1)
        , x(std::move(start.x))
        , Fx(zero_like(d_))
        , g(start.gradient ? std::move(*start.gradient) : zero_like(d_))
        , y(zero_like(d_))
        , Fy(zero_like(d_))
        , gy(zero_like(d_))
        , is_rough(start.is_rough)
        , told(zero_like(d_))
      {
        set.predict(x, g);
      }

      NewtonResult<Vector> run()
      {
        const Status status = iterate();
        if (status != Status::converged && best)
          {
            x        = std::move(best->x);
            g        = std::move(best->gradient);
            residual = best->residual;
            set.predict(x, zero_like(x));
          }
        set.put_on_bounds(x); // ties to the last bit
        set.project_on_bounds(x);
        return {status, std::move(x), set.free(), residual, std::move(g), counts};
      }

    private:
      struct Found
      {
        Vector x, gradient;
        double residual; // over the reference
      };

      // Where whole steps began in spite of the residual: the step that was cut there, and what told its set.
      struct Watch
      {
        Vector                                         x, Fx, g, y, Fy, gy, told;
        double                                         error_of_Fx, error_of_Fy, t;
        LineSearch<Vector, ActiveSet<Vector, Problem>> line;
      };

      using Face = decltype(std::declval<Problem>().face(std::vector<bool>(), std::vector<Tie>(), std::vector<Turn>()));

      // The largest weight of a residual over the least, which is 1.
      static double ratio_of_weights(const Problem &problem, const Vector &d)
      {
        const double *weights = residual_weights(problem, 0);
        double        largest = 1;
        for (std::size_t i = 0; weights && i < local_size(d); ++i)
          largest = std::max(largest, weights[i]);
        return -problem.reduction().min(-largest);
      }

      // Gradients are differences of entries of d and F x.
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
              return converged_at_y();
            solve(*face);
            ++counts.outer_iterations;
            const double left = measure();
            report();
            if (!std::isfinite(residual))
              return Status::stagnated;
            if (is_accepted() || is_solution(*face, left))
              return converged_at_y();
            check_start_of_face(left);
            if (!step())
              return ended(Status::stagnated);
          }
        return ended(Status::iteration_limit);
      }

      // Fills the residual of y. @return it with the violation of the bounds, over the reference.
      double measure()
      {
        const auto [gradient, violation] = set.residuals(y, gy);
        residual                         = gradient / goal.reference;
        return residual + violation / goal.reference;
      }

      // x, where it was not found on a face, may be the solution: the start, as that of loads which hardly differ from those before, or
      // the end of a step that was cut. A step on a face whose matrix is nearly singular could lead far away from it.
      bool solves_already(const Face &face)
      {
        if (!(line.present() <= goal.tolerance * goal.reference))
          return false;
        y  = x;
        Fy = Fx;
        gradient_on(face, y, Fy, gy);
        const double left = measure();
        if (!is_solution(face, left))
          return false;
        report();
        return true;
      }

      // y with this residual, x or on the face. If it meets the goal, but is not right, it is kept as the best, and faces
      // are solved to less from now on.
      bool is_solution(const Face &face, double left)
      {
        if (left <= goal.tolerance)
          left += imbalance(face);
        if (!(left <= goal.tolerance))
          return false;
        best = Found{y, gy, residual};
        if (left <= options.least_part * goal.tolerance ||
            (tells_forces(left) && (!is_right || is_right(y, error_on(face)))))
          return true;
        has_met_goal = true;
        tolerance    = options.tightening * left;
        return false;
      }

      Status converged_at_y()
      {
        std::swap(x, y);
        std::swap(g, gy);
        return Status::converged;
      }

      // A face that is solved to the goal, but on a set whose bounds are violated by far more than before. Where that happens again, sets
      // are told by gradients below the goal (compliances that are far apart), and faces are solved to less.
      void check_start_of_face(const double natural_residual)
      {
        if (residual <= goal.tolerance &&
            natural_residual > options.astray * std::max(goal.tolerance, last_natural_residual) && ++n_astray > 1)
          tolerance = std::min(tolerance, options.tightening * residual);
        last_natural_residual = natural_residual;
      }

      // Where gaps of open contact make the reference, the forces may be next to nothing beside it.
      bool tells_forces(const double left) const
      {
        return left * goal.reference <= options.gaps_over_forces * goal.tolerance * norm * size_of_forces(y);
      }

      // Forces that are left of larger ones, as where loads end, are small beside these.
      double size_of_forces(const Vector &forces) const
      {
        return std::max(std::isfinite(goal.forces) ? goal.forces : 0., qp::norm(forces, problem.reduction()));
      }

      // Residuals below the goal that do not fall any more are at rounding.
      Status ended(const Status status)
      {
        if (!has_met_goal)
          return status;
        x        = std::move(best->x);
        g        = std::move(best->gradient);
        residual = best->residual;
        set.predict(x, g);
        return Status::converged;
      }

      // By how much y, put on its bounds, would have to change for G x = e: over the reference, or over y itself, which is
      // more where the reference is that of gaps, beside which what forces do is next to nothing.
      double imbalance(const Face &face)
      {
        Vector at = y;
        set.put_on_bounds(at);
        Vector balanced = at;
        face.balance(balanced);
        const double size = size_of_forces(balanced);
        add(-1., at, balanced);
        const double missing = qp::norm(balanced, problem.reduction());
        return missing > 0 ? missing * std::max(norm / goal.reference, 1 / size) : 0.;
      }

      // M r on the free entries, and how far the others are from their bounds: nearly the error of y.
      Vector error_on(const Face &face)
      {
        Vector r(gy), error(gy);
        combine(-1., gy, 0., r);
        face.precondition(static_cast<const Vector &>(r), error);
        ++counts.preconditioner_applications;
        face.project_kernel(error);
        Vector at = y;
        set.put_on_bounds(at);
        set.project_on_bounds(at);
        for (std::size_t i = 0; i < local_size(at); ++i)
          error.begin()[i] += at.begin()[i] - y.begin()[i];
        return error;
      }

      // The face of the set. Where that leaves a motion open, the entries at bounds that come nearest to leaving them hold
      // it; where a step failed, motions that the free entries hardly hold count as open.
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

      // x to its bounds and to where G x = e, F x, gradient and set.
      bool begin()
      {
        auto face = regular_face();
        if (!face)
          return false;
        set.put_on_bounds(x);
        face->balance(x);
        problem.multiply(x, Fx);
        ++counts.hessian_multiplications;
        gradient_on(*face, x, Fx, g);
        line.begin(set.natural_residual(x, g));
        predict(x, g);
        return true;
      }

      // The set that a point and its gradient tell. Natural residuals with different s cannot be compared: those of the last steps
      // are taken for as much larger or smaller with the new one as that of x is.
      void predict(const Vector &at, const Vector &gradient)
      {
        const double before = set.step_length();
        told                = gradient;
        set.predict(at, gradient);
        if (set.step_length() == before || !(line.present() > 0))
          return;
        const double factor = set.natural_residual(x, g) / line.present();
        line.rescale(factor);
        if (watch)
          watch->line.rescale(factor);
      }

      // g = F x - d + G'a with the a that makes it, with what the turns of forces add, least on the free entries.
      void gradient_on(const Face &face, const Vector &at, const Vector &product, Vector &gradient) const
      {
        combine(1.0, product, 0.0, gradient);
        add(-1.0, d, gradient);
        Vector shift(gradient), left(gradient);
        add_compliance(set.turns(), at, left);
        face.multiplier_shift(static_cast<const Vector &>(left), shift);
        add(-1.0, shift, gradient);
      }

      // Of the next face, falling with the residual (Levenberg, Marquardt): where forces are not unique the method converges to
      // the nearest ones, as fast as elsewhere (Fan, Yuan 2005). What a face leaves of the residual, over this, is how far forces
      // wander that F does not determine.
      double regularization() const
      {
        return is_singular ? std::min(options.largest_regularization, line.present() / goal.reference) : 0.;
      }

      // y, F y, and gradient of y: the solution on the face, up to a part of the present residual.
      void solve(const Face &face)
      {
        y = x;
        set.put_on_bounds(y);
        face.balance(y);
        const Vector center(y);
        step_to_start(face);
        FaceSolver<Vector, Face> solver(
          face,
          d,
          store,
          [this](const Vector &p) { return set.conditions(p, ties); },
          options.face,
          set.turns(),
          regularization());
        const double first  = solver.start(std::move(y), std::move(Fy), error_of_Fx, center);
        const double target = std::min(std::max(options.last_forcing * tolerance * goal.reference,
                                                (is_singular ? options.singular_forcing : options.forcing) *
                                                  std::min(first, line.present())),
                                       options.sharpening * solved.least_of_earlier(set.sides(), problem.reduction()));
        auto         result = has_ties() ? solver.solve_unsymmetric(target) : solver.solve_symmetric(target);
        if (is_singular || has_wide_stiffnesses)
          solved.add(set.sides(), result.residual);
        counts += result.counts;
        y           = std::move(result.x);
        Fy          = std::move(result.product);
        error_of_Fy = result.error;
        gradient_on(face, y, Fy, gy);
      }

      // on any process
      bool has_ties() const
      {
        return problem.reduction().min(ties.empty() ? 1. : 0.) < 1;
      }

      // F y by the product with the step from x, which is a direction as all others; steps of rounding are none.
      void step_to_start(const Face &face)
      {
        constexpr double rounding = 1e-13, no_direction = 1e-6; // over |y|
        Vector           step(y), product(y);
        add(-1., x, step);
        const auto s = problem.reduction().sum(std::array<double, 2>{{local_dot(step, step), local_dot(y, y)}});
        std::copy(Fx.begin(), Fx.end(), Fy.begin());
        if (s[0] <= rounding * rounding * s[1])
          return;
        descend(face, step);
        std::copy(x.begin(), x.end(), y.begin());
        add(1., step, y);
        problem.multiply(step, product);
        ++counts.hessian_multiplications;
        add(1., product, Fy);
        if (s[0] > no_direction * no_direction * s[1]) // else G step = 0 holds to few digits
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

      // A short step along the preconditioned residual of the face goes with the one onto its bounds: F is multiplied anyway.
      void descend(const Face &face, Vector &step)
      {
        Vector r(g), shift(g), p(g);
        add_compliance(set.turns(), x, r);
        face.multiplier_shift(static_cast<const Vector &>(r), shift);
        add(-1., shift, r);
        combine(-1., r, 0., r);
        face.precondition(static_cast<const Vector &>(r), p);
        ++counts.preconditioner_applications;
        face.project_kernel(p);
        add(descent_step, p, step);
      }

      // Along the step to the next point and set. @return is there one?
      bool step()
      {
        double t    = line.search(set, x, g, y, gy);
        is_unjudged = false;
        if (watch ? goes_on() : t < options.shortest_step && goes_off(t))
          {
            refused.clear();
            go_whole();
            return true;
          }
        if (watch)
          t = come_back();
        if (t < options.shortest_step)
          {
            if (has_met_goal)
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
          {
            predict(line.refused().x, line.refused().gradient);
            return true;
          }
        Vector known(g);
        if (t == 1)
          set.clear_solved(x, known);
        predict(x, known);
        return true;
      }

      // Next to x the natural residual has a kink, where entries come to their bounds or leave them. The set beyond it is that of the
      // derivative along the step (Pang 1990); its own step may lead across others. @return was it not tried yet from x?
      bool cross_kink()
      {
        refused.add(set.sides());
        if (refused.size() > most_kinks)
          return false;
        predict(line.refused().x, line.refused().gradient);
        return !refused.contains(set.sides(), problem.reduction());
      }

      // From the set of x itself, with bodies balanced finely, then also on softer points, where that is possible. @return whether it
      // was not tried yet.
      bool restart()
      {
        const bool is_changed = set.balance_finely() || set.soften(), is_first = !is_stuck;
        is_stuck = true;
        if (is_changed)
          line.begin(set.natural_residual(x, g));
        predict(x, g);
        return is_changed || is_first;
      }

      // Once from a rough start the whole step all the same, wherever it leads. @return whether there was such a step left.
      bool leap()
      {
        if (!is_rough || !(line.whole() <= options.longest_leap * line.present()))
          return false;
        is_rough = false;
        go_whole();
        return true;
      }

      // Where a step would be cut to next to nothing, whole ones are taken all the same (watchdog technique: Chamberlain,
      // Powell, Lemarechal, Pedersen 1982), since the set at their end often is much better than its residual tells. They go
      // on while each but the first halves the residual, until it is below the bound of the line search where they began;
      // else the method goes back there.
      // @param t of the step that is cut. @return is it worth while?
      bool goes_off(const double t)
      {
        if (has_met_goal || n_cut++ < n_cut_before_watch || !(line.whole() <= options.largest_rise * line.present()))
          return false;
        watch.emplace(Watch{x, Fx, g, y, Fy, gy, told, error_of_Fx, error_of_Fy, t, line});
        return true;
      }

      bool goes_on()
      {
        if (line.whole() <= (1 - options.sufficient_decrease) * watch->line.most())
          {
            watch.reset();
            n_cut = n_cut_before_watch = 0;
            return true;
          }
        return line.whole() <= options.least_progress * line.present();
      }

      // To where whole steps began; the next ones have to wait for more steps that are cut. @return how much of the step
      // there is taken.
      double come_back()
      {
        const double t = watch->t;
        x              = std::move(watch->x);
        Fx             = std::move(watch->Fx);
        g              = std::move(watch->g);
        y              = std::move(watch->y);
        Fy             = std::move(watch->Fy);
        gy             = std::move(watch->gy);
        error_of_Fx    = watch->error_of_Fx;
        error_of_Fy    = watch->error_of_Fy;
        line           = std::move(watch->line);
        predict(x, watch->told);
        watch.reset();
        n_cut              = 0;
        n_cut_before_watch = 2 * n_cut_before_watch + 1;
        return t;
      }

      void go_whole()
      {
        go_to_y(line.whole());
        is_stuck = false;
        Vector known(g);
        set.clear_solved(x, known);
        predict(x, known);
      }

      // x to the end of the step that the line search found.
      void move_by_part(const double t)
      {
        if (t < 1)
          {
            std::swap(y, line.end().x);
            std::swap(gy, line.end().gradient);
            combine(1 - t, Fx, t, Fy);
            error_of_Fy = std::max(error_of_Fx, error_of_Fy);
          }
        if (!has_met_goal && line.found() < line.least())
          best = Found{y, gy, line.found() / goal.reference};
        if (!(line.found() < line.present()) && (t == 1 || !set.balance_finely()))
          set.soften();
        go_to_y(line.found());
      }

      void go_to_y(const double merit)
      {
        line.move_to(merit);
        set.approach(merit / goal.reference);
        std::swap(x, y);
        std::swap(Fx, Fy);
        std::swap(error_of_Fx, error_of_Fy);
        std::swap(g, gy);
      }

      bool is_accepted()
      {
        if (!accepts)
          return false;
        Vector at = y;
        set.put_on_bounds(at);
        return accepts(at, gy);
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
      const ErrorTest<Vector>  &is_right;
      const bool                has_wide_stiffnesses; // gradients may tell sets that are below the tolerance
      const bool                is_singular;          // F, on some faces
      double                    tolerance; // that faces are solved to: of the goal, or below it until x is right
      bool                      has_met_goal = false;

      ActiveSet<Vector, Problem>                     set;
      const std::shared_ptr<DirectionStore<Vector>>  directions;
      DirectionStore<Vector>                        &store;
      std::vector<Tie>                               ties; // of the present face
      LineSearch<Vector, ActiveSet<Vector, Problem>> line;
      SetHistory                                     solved;  // residuals are those that faces were solved to
      SetHistory                                     refused; // whose steps do not lower the residual of x

      Vector               x, Fx, g;            // where the method is
      Vector               y, Fy, gy;           // where the present step leads
      bool                 is_unjudged = false; // x: may it be the solution?
      std::optional<Found> best;                // where the natural residual is least, or where the goal was met last
      double               residual              = HUGE_VAL;
      double               last_natural_residual = std::numeric_limits<double>::infinity(); // over the reference
      unsigned int         n_astray              = 0;
      double               error_of_Fx = 0, error_of_Fy = 0; // by rounding, weighted, estimates
      bool                 is_stuck = false;                 // the last step did not lower the residual
      bool                 is_rough; // the start, and no step was made yet in spite of the residual
      Vector               told;     // gradient of the last prediction
      std::optional<Watch> watch;    // whole steps are being taken
      unsigned int         n_cut = 0, n_cut_before_watch = 0; // steps since the last ones, and how many there must be
      Counts               counts;
    };
  } // namespace detail

  /// Minimise 1/2 x'Fx - x'd over the admissible set and G x = e; with bounds that follow the solution the equilibrium
  /// in place of the minimum. `norm` is |PFP|; goal.reference must be given (|P(d - F x~)|). Converged: x is within its
  /// bounds, |gP| and |PFP| |G x - e| are at most goal.tolerance times goal.reference, or @p accepts said so, and @p is_right
  /// agrees or nothing more can be done.
  /// status: infeasible if no entry at a bound leaves the equalities singular all the same; stagnated if the natural
  /// residual does not fall along a step.
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
