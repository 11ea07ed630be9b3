// The faces of the active sets of the semismooth Newton method, and the steps to their solutions.
#pragma once

#include <slipstick/qp/active_set.h>
#include <slipstick/qp/direction_store.h>
#include <slipstick/qp/face_solver.h>
#include <slipstick/qp/newton_point.h>
#include <slipstick/qp/options.h>
#include <slipstick/qp/set_history.h>
#include <slipstick/qp/types.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

namespace slipstick::qp::detail
{
  // Length of a step along M r: eigenvalues of F M are 1 to about 5 (first steps of conjugate gradients: 0.15 to
  // 0.5).
  constexpr double descent_step = 0.3;
  // A face is solved to no less than this times the rounding error of F x at its start.
  constexpr double rounding_of_residual = 10;

  /// Solves faces of the present set, with the directions of all earlier ones. How the problem and its faces must look:
  /// semismooth_newton.h.
  template <typename Vector, typename Problem>
  class NewtonFaces
  {
  public:
    using Point = NewtonPoint<Vector>;
    using Face  = decltype(std::declval<Problem>().face(std::vector<bool>(), std::vector<Tie>(), std::vector<Turn>()));

    /// @param set, counts are changed; all but the store are kept by reference. @param directions null: a new store.
    NewtonFaces(const Problem                          &problem_,
                const double                            norm_,
                const Vector                           &d_,
                const Goal                             &goal_,
                const NewtonOptions                    &options_,
                std::shared_ptr<DirectionStore<Vector>> directions_,
                ActiveSet<Vector, Problem>             &set_,
                Counts                                 &counts_)
      : problem(problem_)
      , norm(norm_)
      , d(d_)
      , goal(goal_)
      , options(options_)
      , set(set_)
      , counts(counts_)
      , has_wide_stiffnesses(ratio_of_weights(problem_, d_) > options_.wide_stiffnesses)
      , minimises_residuals(has_wide_stiffnesses && set_.may_have_ties())
      , is_singular(dependent_compliances(problem_, 0) != nullptr)
      , directions(directions_ ? std::move(directions_)
                               : std::make_shared<DirectionStore<Vector>>(options_.n_directions))
      , store(*directions)
      , solved(options_.n_remembered_sets)
    {}

    /// The face of the set. If it leaves a motion open, the entries at bounds that are closest to leaving them hold it.
    /// @param is_stuck whether the last step failed: motions that the free entries hardly resist count as open, too
    std::optional<Face> regular(const bool is_stuck)
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

    /// F x - d + G'a, with the a that minimises it on the free entries, including the gradient of turned forces.
    void fill_gradient(const Face &face, Point &at) const
    {
      combine(1.0, at.Fx, 0.0, at.gradient);
      add(-1.0, d, at.gradient);
      Vector shift(at.gradient), left(at.gradient);
      add_compliance(set.turns(), at.x, left);
      face.multiplier_shift(static_cast<const Vector &>(left), shift);
      add(-1.0, shift, at.gradient);
    }

    /// Computes F x and the gradient anew.
    void multiply(const Face &face, Point &at) const
    {
      problem.multiply(at.x, at.Fx);
      ++counts.hessian_multiplications;
      at.error_of_Fx = rounding_of_product(
        problem.reduction().sum(std::array<double, 1>{{local_squares(residual_weights(problem, 0), at.x, at.Fx)}})[0]);
      fill_gradient(face, at);
    }

    /// `next` becomes the solution on the face, up to a part of the present residual.
    /// @param merit natural residual of `now`. @param tolerance of faces, over the reference.
    void solve(const Face &face, const double merit, const double tolerance, const Point &now, Point &next)
    {
      next.x = now.x;
      set.put_on_bounds(next.x);
      face.balance(next.x);
      const Vector center(next.x);
      step_to_start(face, now, next);
      FaceSolver<Vector, Face> solver(
        face,
        d,
        store,
        [this](const Vector &p) { return set.conditions(p, ties); },
        options.face,
        set.turns(),
        regularization(merit));
      const double first  = solver.start(std::move(next.x), std::move(next.Fx), now.error_of_Fx, center);
      const double target = target_of(std::min(first, merit), tolerance, now.error_of_Fx);
      auto         result =
        has_ties() || minimises_residuals ? solver.solve_unsymmetric(target) : solver.solve_symmetric(target);
      if (is_singular || (has_wide_stiffnesses && !minimises_residuals))
        solved.add(set.sides(), result.residual);
      counts += result.counts;
      next.x           = std::move(result.x);
      next.Fx          = std::move(result.product);
      next.error_of_Fx = result.error;
      restore_balance(face, tolerance, next);
      fill_gradient(face, next);
    }

  private:
    // Residual to which a face is solved. @param residual at its start. @param tolerance, rounding as in solve().
    double target_of(const double residual, const double tolerance, const double rounding) const
    {
      const double rounded = rounding_of_residual * rounding;
      const double least   = minimises_residuals ? rounded : options.last_forcing * tolerance * goal.reference;
      const double part    = is_singular ? options.singular_forcing : options.forcing;
      const double earlier = solved.least_of_earlier(set.sides(), problem.reduction());
      return std::min(std::max(least, part * residual), std::max(rounded, options.sharpening * earlier));
    }

    // The largest weight of a residual over the smallest, which is 1.
    static double ratio_of_weights(const Problem &problem, const Vector &d)
    {
      const double *weights = residual_weights(problem, 0);
      double        largest = 1;
      for (std::size_t i = 0; weights && i < local_size(d); ++i)
        largest = std::max(largest, weights[i]);
      return -problem.reduction().min(-largest);
    }

    // Regularisation of the next face, which decreases with the residual (Levenberg, Marquardt): where forces are not
    // unique, the method converges to the nearest ones, as fast as elsewhere (Fan, Yuan 2005). The residual that a
    // face leaves, divided by this, is the distance by which forces may drift that F does not determine.
    double regularization(const double merit) const
    {
      return is_singular ? std::min(options.largest_regularization, merit / goal.reference) : 0.;
    }

    // Directions satisfy G p = 0 up to rounding, and so do their combinations unless they cancel. What is missing of G
    // x = e is restored; otherwise it would grow from face to face, since steps between points become directions.
    void restore_balance(const Face &face, const double tolerance, Point &next)
    {
      Vector balanced(next.x), product(next.x);
      face.balance(balanced);
      add(-1., next.x, balanced);
      const double missing = qp::norm(balanced, problem.reduction());
      if (!(missing > force_rounding * qp::norm(next.x, problem.reduction())))
        return;
      add(1., balanced, next.x);
      if (norm * missing <= options.face.accuracy * options.last_forcing * tolerance * goal.reference)
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
    void step_to_start(const Face &face, const Point &now, Point &next)
    {
      constexpr double no_direction = 1e-6; // relative to |x|
      Vector           step(next.x), product(next.x);
      add(-1., now.x, step);
      const auto s = problem.reduction().sum(std::array<double, 2>{{local_dot(step, step), local_dot(next.x, next.x)}});
      std::copy(now.Fx.begin(), now.Fx.end(), next.Fx.begin());
      if (s[0] <= force_rounding * force_rounding * s[1])
        return;
      descend(face, now, step);
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
    void descend(const Face &face, const Point &now, Vector &step)
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

    const Problem              &problem;
    const double                norm;
    const Vector               &d;
    const Goal                 &goal;
    const NewtonOptions        &options;
    ActiveSet<Vector, Problem> &set;
    Counts                     &counts;
    const bool                  has_wide_stiffnesses; // sets depend on gradients below the tolerance
    const bool                  minimises_residuals;  // on all faces down to rounding: stiffnesses differ, ties
    const bool                  is_singular;          // whether F is singular on some faces

    const std::shared_ptr<DirectionStore<Vector>> directions;
    DirectionStore<Vector>                       &store;
    std::vector<Tie>                              ties;   // of the present face
    SetHistory                                    solved; // with the residuals to which faces were solved
  };
} // namespace slipstick::qp::detail
