// Semismooth Newton (primal-dual active set) for bounds and equalities, with inexact projected conjugate gradients on
// the free entries. Hintermueller, Ito, Kunisch 2003; on the multipliers of FETI: method.md section 7.
//
// Bounds that follow the solution (Coulomb friction) are differentiated too: a slipping entry is tied to its normal one,
// x_T = +-(fixed + coefficient x_N), within each linear problem (Alart, Curnier 1991, on the multipliers), which GCR
// solves since ties make it unsymmetric. Or they are followed in an outer loop (BoundUpdate).
//
// Besides the Problem of types.h it needs
//   `auto face(const std::vector<bool> &free, const std::vector<Tie> &ties) const`   the problem on the free entries
//       (owned ones) with others tied to them, which has multiply, reduction as the Problem, and
//       `project_range(x, y)`   y = Q_f x on the free entries, y = x on the others, so that P_f = I - Q_f keeps G x
//       `balance(x)`            moves the free entries (the tied ones with them) by the least that makes G x = e
//       `project_kernel(p)`     the same for G p = 0; then sets the tied entries to factor times theirs
//       `multiplier_shift(v, y)` y = G'a on ALL entries, with a such that v - G'a is least on the free ones
//       `precondition(r, z)`    z = M r on the free entries, 0 on the others; symmetric positive semidefinite
//       the Problem and its faces may have residual_weights (pcpg.h): they scale the step to the next set too
//       `is_regular()`          false when the free entries alone do not determine a
#pragma once

#include <slipstick/qp/active_set.h>
#include <slipstick/qp/gcr.h>

#include <cmath>
#include <functional>
#include <optional>
#include <vector>

namespace slipstick::qp
{
  /// Bounds that depend on the solution (Coulomb friction), followed in an outer loop: called with x when the active set
  /// of the present bounds stands and its residual is small against their last change. Changes the box that the solver
  /// was given, or leaves it when the change is below `tolerance`; returns the relative change, or none to give up.
  template <typename Vector>
  struct BoundUpdate
  {
    std::function<std::optional<double>(const Vector &x)> update; // empty: the bounds are fixed
    double                                                tolerance = 0;
  };

  /// The point that tells the first active set: entries at their bounds, or, with the gradient F x - d + G'a, those that
  /// a step along it takes there.
  template <typename Vector>
  struct NewtonStart
  {
    Vector                x;
    std::optional<Vector> gradient = std::nullopt;
  };

  /// Ends the method before its goal is reached: called with x and its gradient F x - d + G'a after every solve of a set,
  /// on every process with the same result.
  template <typename Vector>
  using Acceptance = std::function<bool(const Vector &x, const Vector &gradient)>;

  template <typename Vector>
  struct NewtonResult
  {
    Status            status;
    Vector            x;                  // free entries within their bounds when converged, the others at them
    std::vector<bool> free;               // owned entries
    double            projected_gradient; // |gP| over the reference of the goal
    Counts            counts;
  };

  namespace detail
  {
    // Outer steps without progress, after which the set counts as cycling and changes by single entries ...
    constexpr unsigned int cycling = 6;
    // ... so often at most.
    constexpr unsigned int most_single_changes = 60;
    // Residual reduction by the linear solves of such sets.
    constexpr double cautious_reduction = 1e-2;

    template <typename Vector, typename Problem>
    class SemismoothNewton
    {
    public:
      SemismoothNewton(const Problem             &problem_,
                       const double               norm_,
                       const Vector              &d_,
                       const Box<Vector>         &box_,
                       NewtonStart<Vector>        start,
                       const Goal                &goal,
                       const NewtonOptions       &options_,
                       const PcpgOptions         &pcpg_options_,
                       const Observer            &observer_,
                       const BoundUpdate<Vector> &bounds_,
                       const CoupledBounds       &coupled_,
                       const Acceptance<Vector>  &accepts_)
        : problem(problem_)
        , norm(norm_)
        , d(d_)
        , options(options_)
        , pcpg_options(pcpg_options_)
        , observer(observer_)
        , bounds(bounds_)
        , coupled(coupled_)
        , accepts(accepts_)
        , set(problem_, norm_, box_, options_, coupled_)
        , x(std::move(start.x))
        , Fx(zero_like(d))
        , g(start.gradient ? std::move(*start.gradient) : zero_like(d))
        , w(d)
        , reference(goal.reference)
        , eps(goal.tolerance)
        , forcing(options.first_forcing)
      {
        bound_change = bounds.update ? 1. : 0.;
        has_gradient = problem.reduction().sum(std::array<double, 1>{{local_dot(g, g)}})[0] > 0;
        set.become(set.next(x, g));
      }

      NewtonResult<Vector> run()
      {
        const Status status = iterate();
        set.put_on_bounds(x); // ties to the last bit
        project(set.box(), x);
        return {status, std::move(x), set.free(), residual, counts};
      }

    private:
      Status iterate()
      {
        double       best  = HUGE_VAL;
        unsigned int stuck = 0, alone = 0; // outer steps without progress, those with one change of the set or none
        for (;;)
          {
            if (!solve_on_face())
              return Status::infeasible;
            auto         next    = set.next(x, g);
            const double changed = set.count_changes(next);
            report();
            if (!(residual < HUGE_VAL))
              return Status::stagnated;
            if (!bounds.update && residual + violation <= eps)
              return Status::converged;
            if (accepts && !bounds.update && is_accepted())
              return Status::converged;
            // ties that were left out (a set that does not hold the bodies) leave entries off the bounds that follow x
            const bool off_bounds = coupled.are_coupled && violation > eps;
            if (changed == 0 && !off_bounds &&
                residual <= std::max(eps, std::min(options.first_forcing, options.bound_accuracy * bound_change)))
              {
                if (bounds.update)
                  {
                    const auto change = bounds.update(x);
                    if (!change)
                      return Status::iteration_limit;
                    bound_change = *change;
                  }
                if (residual <= eps && bound_change <= bounds.tolerance)
                  return Status::converged;
                if (bound_change > bounds.tolerance)
                  {
                    tighten();
                    forcing =
                      std::max(options.last_forcing * eps, std::min(forcing, options.bound_reduction * solved_to));
                    solved_to   = forcing;
                    next        = set.next(x, g);
                    set_stands  = set.same_free(next);
                    set_changed = true;
                    set.become(std::move(next));
                    best  = HUGE_VAL;
                    stuck = alone = 0;
                    continue;
                  }
              }
            // progress: the residual or the number of changes falls below the best so far
            const double merit = residual + changed;
            stuck              = merit < options.progress * best ? 0 : stuck + 1;
            best               = std::min(best, merit);
            // single changes are of no help when they are all that there is
            alone = stuck == 0 ? 0 : alone + (changed <= 1);
            if (alone >= options.patience || stuck >= options.patience + most_single_changes)
              return Status::stagnated;
            is_cautious = stuck >= cycling;
            if (is_cautious)
              set.keep_largest_changes(x, g, std::floor(changed * std::pow(0.5, stuck - cycling + 1.)), next);
            if (counts.outer_iterations >= options.max_outer_iterations)
              return Status::iteration_limit;
            if (changed <= options.settled_part * set.n_inequalities())
              tighten();
            set_changed = changed > 0 || off_bounds;
            set_stands  = coupled.are_coupled ? changed == 0 && !off_bounds : set.same_free(next);
            set.become(std::move(next));
          }
      }

      // Smaller residuals for the solves to come; bounds that move are not worth more than a part of their last change.
      void tighten()
      {
        const bool   follows = bounds.update && bound_change > bounds.tolerance;
        const double next    = follows ? std::max(options.last_forcing * forcing,
                                               options.last_forcing * options.bound_accuracy * bound_change)
                                       : options.forcing_reduction * forcing;
        forcing              = std::max(options.last_forcing * eps, std::min(forcing, next));
      }

      using Face = decltype(std::declval<Problem>().face(std::vector<bool>(), std::vector<Tie>()));

      // The linear problem of the present set; entries that are not free at their bounds.
      bool solve_on_face()
      {
        std::optional<Face> face;
        face.emplace(problem.face(set.free(), set.ties()));
        if (!face->is_regular())
          {
            // entries between two bounds are freed: what they hold in the solution is not known yet
            set_stands  = false;
            set_changed = true;
            set.free_two_sided();
            face.emplace(problem.face(set.free(), {}));
            if (!face->is_regular())
              {
                // then all of them: the set that follows keeps those that press
                if (++n_freed > options.max_freed)
                  return false;
                set.free_all();
                face.emplace(problem.face(set.free(), {}));
                if (!face->is_regular())
                  return false;
              }
          }
        if (!set_stands)
          {
            history.reset();
            residual_history.reset();
          }
        if (set_changed)
          {
            const std::optional<Vector> step = has_gradient ? std::make_optional(descent(*face)) : std::nullopt;
            set.put_on_bounds(x);
            face->balance(x);
            if (step)
              add(-std::min(options.descent_step, last_step), *step, x);
            problem.multiply(x, Fx);
            ++counts.hessian_multiplications;
          }
        const double reduction =
          is_cautious ? std::min(options.face_reduction, cautious_reduction) : options.face_reduction;
        wanted =
          std::max(options.last_forcing * eps, std::min(set_changed ? 1. : forcing, reduction * residual_on(*face)));
        if (coupled.are_coupled && !set.all_stick())
          solve_unsymmetric(*face);
        else
          solve_symmetric(*face);
        ++counts.outer_iterations;
        combine(1.0, Fx, 0.0, g);
        add(-1.0, d, g);
        face->multiplier_shift(g, w);
        add(-1.0, w, g);
        has_gradient = true;
        measure();
        return true;
      }

      // The preconditioned gradient of the face before entries that have left it are put on their bounds. A short step
      // along it goes with that one since F is multiplied with x anyway.
      Vector descent(const Face &face)
      {
        Vector r(g), z(g);
        face.project_range(g, w);
        add(-1.0, w, r);
        face.precondition(r, z);
        ++counts.preconditioner_applications;
        project_kernel(face, z, w, 0);
        return z;
      }

      // |P(d - F x)| over the reference, of the face.
      double residual_on(const Face &face)
      {
        combine(1.0, d, 0.0, g);
        add(-1.0, Fx, g);
        face.project_range(g, w);
        add(-1.0, w, g);
        const double *weights = residual_weights(problem, 0);
        return std::sqrt(problem.reduction().sum(std::array<double, 1>{{local_weighted_dot(weights, g, g)}})[0]) /
               reference;
      }

      void solve_symmetric(const Face &face)
      {
        if (!history)
          history = std::make_shared<DirectionHistory<Vector>>();
        auto result = pcpg(face,
                           d,
                           PcpgStart<Vector>{std::move(x), std::move(Fx), history},
                           Goal(wanted, reference),
                           pcpg_options,
                           [&face](const Vector &r, Vector &z) { face.precondition(r, z); });
        x           = std::move(result.x);
        Fx          = std::move(result.product);
        counts += result.counts;
        if (result.first_step > 0)
          last_step = result.first_step;
      }

      void solve_unsymmetric(const Face &face)
      {
        if (!residual_history)
          residual_history.emplace();
        auto result = gcr(face,
                          d,
                          std::move(x),
                          std::move(Fx),
                          *residual_history,
                          Goal(wanted, reference),
                          options.gcr,
                          [&face](const Vector &r, Vector &z) { face.precondition(r, z); });
        x           = std::move(result.x);
        Fx          = std::move(result.product);
        counts += result.counts;
        if (result.first_step > 0)
          last_step = result.first_step;
      }

      // Asks with entries on their bounds to the last bit.
      bool is_accepted()
      {
        Vector before = x;
        set.put_on_bounds(x);
        if (accepts(x, g))
          return true;
        x = std::move(before);
        return false;
      }

      // |gP|, and how far x is out of its bounds: as much, at most, does |gP| rise when x is moved there.
      void measure()
      {
        set.move_bounds(x);
        const auto            l = set.box().lower.begin(), u = set.box().upper.begin();
        const auto            xi = x.begin(), gi = g.begin();
        const auto           &active  = set.sides();
        const double         *weights = residual_weights(problem, 0);
        std::array<double, 2> sum{{0, 0}};
        for (std::size_t i = 0; i < active.size(); ++i)
          {
            const double gp = active[i] == 0   ? gi[i]
                              : !(l[i] < u[i]) ? 0.0
                              : active[i] < 0  ? std::min(gi[i], 0.0)
                                               : std::max(gi[i], 0.0);
            // entries at a bound must be there: bounds that follow x may have left them
            const double out    = xi[i] - (active[i] < 0 ? l[i] : active[i] > 0 ? u[i] : clip(xi[i], l[i], u[i]));
            const double weight = weights ? weights[i] : 1.;
            sum[0] += weight * weight * gp * gp;
            sum[1] += out * out; // F out is as much smaller as the weight is larger
          }
        sum       = problem.reduction().sum(sum);
        residual  = std::sqrt(sum[0]) / reference;
        violation = norm * std::sqrt(sum[1]) / reference;
      }

      void report() const
      {
        if (observer)
          observer({counts.outer_iterations,
                    counts.hessian_multiplications,
                    residual,
                    0.0,
                    static_cast<std::size_t>(set.n_lower()),
                    static_cast<std::size_t>(set.n_upper())});
      }

      const Problem             &problem;
      const double               norm;
      const Vector              &d;
      const NewtonOptions       &options;
      const PcpgOptions         &pcpg_options;
      const Observer            &observer;
      const BoundUpdate<Vector> &bounds;
      const CoupledBounds       &coupled;
      const Acceptance<Vector>  &accepts;

      ActiveSet<Vector, Problem> set;

      Vector       x, Fx, g, w;
      const double reference, eps;
      double       forcing, wanted = 0;
      double       solved_to    = 1; // forcing at the last update of the bounds
      double       residual     = HUGE_VAL;
      double       violation    = HUGE_VAL; // of the bounds by x, over the reference, in terms of the residual
      double       bound_change = 0;        // the last one
      double       last_step = HUGE_VAL; // the first one of the last solve of a face, along its preconditioned residual
      bool         has_gradient;         // g is that of x
      bool         is_cautious = false;  // the set changes by one entry at a time
      bool         set_changed = true;   // x is not on its bounds, or does not balance: F x is not known
      bool         set_stands  = false;  // the free entries are those of the last solve
      unsigned int n_freed     = 0;      // sets that left some motion open, so that all entries were freed
      std::shared_ptr<DirectionHistory<Vector>> history;
      std::optional<ResidualHistory<Vector>>    residual_history;
      Counts                                    counts;
    };
  } // namespace detail

  /// Minimise 1/2 x'Fx - x'd over the box and G x = e.
  /// `norm` is |PFP|; goal.reference must be given (|P(d - F x~)|). Converged: x is within its bounds, |gP| and |PFP| |G x - e| are
  /// at most goal.tolerance times goal.reference (with bounds followed in an outer loop the active set stands besides),
  /// or @p accepts said so (it is not asked while bounds are followed).
  /// status: infeasible if the free entries of some set leave the equalities singular, stagnated if neither residual nor
  /// changes of the set fall any more; MPGP with SMALBE goes on from there.
  template <typename Vector, typename Problem>
  NewtonResult<Vector> semismooth_newton(const Problem             &problem,
                                         const double               norm,
                                         const Vector              &d,
                                         const Box<Vector>         &box,
                                         NewtonStart<Vector>        start,
                                         const Goal                &goal,
                                         const NewtonOptions       &options      = {},
                                         const PcpgOptions         &pcpg_options = {},
                                         const Observer            &observer     = {},
                                         const BoundUpdate<Vector> &bounds       = {},
                                         const CoupledBounds       &coupled      = {},
                                         const Acceptance<Vector>  &accepts      = {})
  {
    return detail::SemismoothNewton<Vector, Problem>(problem,
                                                     norm,
                                                     d,
                                                     box,
                                                     std::move(start),
                                                     goal,
                                                     options,
                                                     pcpg_options,
                                                     observer,
                                                     bounds,
                                                     coupled,
                                                     accepts)
      .run();
  }
} // namespace slipstick::qp
