// The point nearest to zero of a box (or of admissible forces) with equality constraints, or a proof that there is
// none.
//
// min 1/2 |x|^2 over the set and Q x = Q x_e. Dual: x = proj(y), y in the range of Q, maximise the concave
//   theta(y) = 1/2 |proj(y)|^2 - y'proj(y) + y'x_e,   grad theta = r = Q(x_e - proj(y)),
// by a semismooth Newton method (matrix Q D Q, D = derivative of the projection at y) with line search. If that
// stagnates, the proximal point method is used (Rockafellar 1976): y_k+1 maximises theta(y) - eps/2 |y - y_k|^2, whose
// maximum exists and is unique even if there is no such point x. The same Newton method finds it, with Q D Q + eps Q;
// there r = eps (y_k+1 - y_k). If there is no point x, theta is unbounded, and r tends to the shortest Q(x_e - x) over
// the set, a Farkas certificate: r'x <= r'x_e - |r|^2 for all x of the set, while Q x = Q x_e requires r'x = r'x_e.
#pragma once

#include <slipstick/qp/force_set.h>
#include <slipstick/qp/options.h>
#include <slipstick/qp/stagnation.h>
#include <slipstick/qp/types.h>


namespace slipstick::qp
{
  template <typename Vector>
  struct FeasiblePoint
  {
    Status       status;      // converged; infeasible, with a certificate; otherwise neither was found
    Vector       x;           // within the set
    Vector       certificate; // infeasible: r in the range of Q, r'x_e > r'x for all x of the set; else Q(x_e - x)
    double       residual;    // |Q(x - x_e)| over the reference length max(|Q x_e|, |projection of 0 on the set|)
    unsigned int newton_steps;
    unsigned int projections; // multiplications with Q
  };

  namespace detail
  {
    /// Result of the search for the maximum of the proximal point method.
    enum class Maximum
    {
      found,
      not_found, // eps is too small
      feasible,  // the search ended early: x is the point
      infeasible // the search ended early: there is a certificate
    };

    template <typename Vector, typename Problem, typename Set>
    class NearestPoint
    {
    public:
      NearestPoint(const Problem &problem_, const Vector &x_e, const Set &set_, const FeasiblePointOptions &options_)
        : problem(problem_)
        , reduction(problem.reduction())
        , set(set_)
        , options(options_)
        , Qx_e(x_e)
        , y(zero_like(x_e))
        , center(y)
        , x(y)
        , r(y)
        , gradient(y)
        , d(y)
        , p(y)
        , Ap(y)
        , residual(y)
      {
        project_range(x_e, Qx_e);
        project(set, x);
        const auto s =
          reduction.sum(std::array<double, 3>{{local_dot(Qx_e, Qx_e), local_dot(x, x), n_contradictions(set)}});
        reference = std::sqrt(std::max(s[0], s[1]));
        is_empty  = s[2] > 0;
      }

      FeasiblePoint<Vector> run()
      {
        Status status = is_empty ? Status::infeasible : newton();
        if (status != Status::converged && status != Status::infeasible)
          {
            set_zero(y);
            status = proximal_points();
          }
        const double scale = reference > 0 ? reference : 1.0;
        return {status, std::move(x), std::move(r), norm_r / scale, newton_steps, projections};
      }

    private:
      void project_range(const Vector &v, Vector &Qv)
      {
        problem.project_range(v, Qv);
        ++projections;
      }

      bool proves_infeasibility(const Vector &v) const
      {
        return is_farkas_certificate(set,
                                     v,
                                     Qx_e,
                                     options.certificate_radius * reference,
                                     options.certificate_margin,
                                     reduction);
      }

      // x = proj(y), r = Q(x_e - x), gradient of theta(y) - eps/2 |y - y_k|^2
      void update_residual()
      {
        std::copy(y.begin(), y.end(), x.begin());
        project(set, x);
        project_range(x, r);
        combine(1.0, Qx_e, -1.0, r);
        norm_r = norm(r, reduction);
        std::copy(r.begin(), r.end(), gradient.begin());
        add(-eps, y, gradient);
        add(eps, center, gradient);
      }

      // Newton's method for theta itself. It stagnates if theta has no maximum.
      Status newton()
      {
        constexpr double regularization = 1e-8; // of the Newton matrix only
        StagnationWatch  stagnates(options.stagnation_window, options.stagnation_progress);
        for (;; ++newton_steps)
          {
            eps = 0;
            update_residual();
            if (norm_r <= options.tolerance * reference)
              return Status::converged;
            if (proves_infeasibility(r))
              return Status::infeasible;
            if (stagnates(norm_r))
              return Status::stagnated;
            if (newton_steps == options.max_plain_steps)
              return Status::iteration_limit;
            eps = regularization;
            find_direction(norm_r);
            eps = 0;
            add(line_search(), d, y);
          }
      }

      // eps is reduced while the residual decreases: y moves by r / eps per point, and its rounding error should remain
      // small beside r. If a proof is wanted, it is reduced as well where r stagnates while that is so: without a point
      // x, r may turn into a certificate only as y grows.
      Status proximal_points()
      {
        StagnationWatch stagnates(options.stagnation_window, options.stagnation_progress);
        double          before   = HUGE_VAL; // |r| of the previous point
        bool            hurries  = false;
        double          accuracy = options.maximum_tolerance;
        eps                      = options.first_regularization;
        for (;;)
          {
            const Maximum maximum = find_maximum(accuracy);
            if (maximum == Maximum::feasible)
              return Status::converged;
            if (maximum == Maximum::infeasible)
              return Status::infeasible;
            const bool has_settled = norm_r > options.progress * before;
            if (has_settled && norm_r <= std::max(options.tolerance * reference,
                                                  std::min(options.rounding * norm(y, reduction),
                                                           options.largest_rounding * reference)))
              return Status::converged;
            if (newton_steps >= options.max_plain_steps + options.max_newton_steps)
              return Status::iteration_limit;
            if (maximum == Maximum::found && stagnates(norm_r))
              {
                if (!options.seeks_proof || options.rounding * norm(y, reduction) > options.small_rounding * norm_r)
                  return Status::stagnated;
                hurries = true;
              }
            if (has_settled)
              accuracy *= options.reduction;
            if (maximum == Maximum::not_found)
              eps = std::min(eps / options.reduction, options.first_regularization);
            else if (hurries || norm_r < options.stagnation_progress * before)
              eps = std::max(options.reduction * eps, options.least_regularization);
            before = norm_r;
            std::copy(y.begin(), y.end(), center.begin());
          }
      }

      // Newton's method for the maximum with the present eps and y_k. It ends as soon as the point or a certificate is
      // found. @param accuracy of the gradient, over |r|.
      Maximum find_maximum(const double accuracy)
      {
        for (unsigned int k = 0;; ++k, ++newton_steps)
          {
            update_residual();
            if (norm_r <= options.rounding * reference)
              return Maximum::feasible;
            if (proves_infeasibility(r))
              return Maximum::infeasible;
            const double size = norm(gradient, reduction);
            if (size <=
                std::max(
                  {accuracy * norm_r, options.least_gradient * reference, options.rounding * norm(y, reduction)}))
              return Maximum::found;
            if (k == options.newton_steps_per_maximum ||
                newton_steps >= options.max_plain_steps + options.max_newton_steps)
              return Maximum::not_found;
            find_direction(size);
            add(line_search(), d, y);
          }
      }

      // (Q D Q + eps Q) d = gradient by conjugate gradients; every iterate d is an ascent direction.
      void find_direction(const double norm_gradient)
      {
        const double tolerance =
          std::max(options.least_cg_tolerance, std::min(options.cg_tolerance, norm_gradient / reference)) *
          norm_gradient;
        set_zero(d);
        std::copy(gradient.begin(), gradient.end(), residual.begin());
        std::copy(gradient.begin(), gradient.end(), p.begin());
        double square = norm_gradient * norm_gradient;
        for (unsigned int k = 0; k < options.max_cg_iterations && std::sqrt(square) > tolerance; ++k)
          {
            multiply_newton_matrix();
            const double pAp = dot(p, Ap, reduction);
            if (!(pAp > 0))
              break;
            add(square / pAp, p, d);
            add(-square / pAp, Ap, residual);
            const double next = dot(residual, residual, reduction);
            combine(1.0, residual, next / square, p);
            square = next;
          }
        project_range(d, p); // keeps y in the range of Q despite rounding
        const bool ascends = dot(p, gradient, reduction) > 0;
        std::copy(ascends ? p.begin() : gradient.begin(), ascends ? p.end() : gradient.end(), d.begin());
      }

      // Ap = (Q D Q + eps Q) p, p in the range of Q
      void multiply_newton_matrix()
      {
        std::copy(p.begin(), p.end(), x.begin());
        multiply_derivative(set, y, x);
        add(eps, p, x);
        project_range(x, Ap);
      }

      // d/dt of theta(y + t d) - eps/2 |y + t d - y_k|^2, decreasing in t
      double slope(const double t)
      {
        std::copy(y.begin(), y.end(), x.begin());
        add(t, d, x);
        std::copy(x.begin(), x.end(), p.begin());
        add(-1.0, center, p);
        project(set, x);
        return reduction.sum(std::array<double, 1>{{local_dot(d, Qx_e) - local_dot(d, x) - eps * local_dot(d, p)}})[0];
      }

      // Step length t > 0 with |slope(t)| small relative to slope(0): expansion, then regula falsi (Illinois).
      double line_search()
      {
        double       low = 0, low_slope = slope(0), high = 1, high_slope = slope(high);
        const double accepted =
          std::max(options.line_search_slope * low_slope, options.rounding * norm(d, reduction) * norm(y, reduction));
        if (std::abs(high_slope) <= accepted)
          return high;
        while (high_slope > accepted && high < options.longest_step)
          {
            low       = high;
            low_slope = high_slope;
            high *= options.line_search_growth;
            high_slope = slope(high);
          }
        if (high_slope >= -accepted)
          return high;
        int last_side = 0;
        for (unsigned int k = 0; k < options.max_line_search_steps; ++k)
          {
            const double t = (low * high_slope - high * low_slope) / (high_slope - low_slope);
            const double s = slope(t);
            if (std::abs(s) <= accepted || !(low < t && t < high))
              return t;
            if (s > 0)
              {
                low       = t;
                low_slope = s;
                high_slope *= last_side == 1 ? 0.5 : 1.0;
                last_side = 1;
              }
            else
              {
                high       = t;
                high_slope = s;
                low_slope *= last_side == -1 ? 0.5 : 1.0;
                last_side = -1;
              }
          }
        return low > 0 ? low : high;
      }

      const Problem                                        &problem;
      decltype(std::declval<const Problem &>().reduction()) reduction;
      const Set                                            &set;
      const FeasiblePointOptions                           &options;

      Vector       Qx_e, y, center, x, r, gradient, d, p, Ap, residual;
      double       eps = 0, reference = 0, norm_r = 0;
      bool         is_empty     = false;
      unsigned int newton_steps = 0, projections = 0;
    };
  } // namespace detail

  /// The point of the set (Box or ForceSet) with Q x = Q x_e that is nearest to zero. Uses only `problem.project_range`
  /// and `problem.reduction`.
  /// status: infeasible with a certificate, see FeasiblePoint (without one if some lower > upper); iteration_limit or
  /// stagnated if neither a point nor a certificate was found.
  /// @code
  /// using Vector = std::vector<double>;
  /// struct Problem // F = diag(1, 3), G = (1, 1) / sqrt(2)
  /// {
  ///   void multiply(const Vector &x, Vector &y) const { y = {x[0], 3 * x[1]}; }
  ///   void project_range(const Vector &x, Vector &y) const { y.assign(2, (x[0] + x[1]) / 2); }
  ///   SerialReduction reduction() const { return {}; }
  /// };
  /// const Box<Vector> box{{0, 0}, {0.5, 2}};
  /// const auto        nearest = feasible_point(Problem(), Vector{1, 1}, box); // x0 + x1 = 2
  /// assert(nearest.status == Status::converged);
  /// assert(std::abs(nearest.x[0] - 0.5) < 1e-9 && std::abs(nearest.x[1] - 1.5) < 1e-9);
  /// @endcode
  template <typename Vector, typename Problem, typename Set>
  FeasiblePoint<Vector> feasible_point(const Problem              &problem,
                                       const Vector               &x_e,
                                       const Set                  &set,
                                       const FeasiblePointOptions &options = {})
  {
    return detail::NearestPoint<Vector, Problem, Set>(problem, x_e, set, options).run();
  }

  template <typename Vector, typename Problem>
  FeasiblePoint<Vector> feasible_point(const Problem              &problem,
                                       const Vector               &x_e,
                                       const Box<Vector>          &box,
                                       const FeasiblePointOptions &options = {})
  {
    return detail::NearestPoint<Vector, Problem, Box<Vector>>(problem, x_e, box, options).run();
  }
} // namespace slipstick::qp
