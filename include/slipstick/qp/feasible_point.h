// The point nearest to zero of a box (or of admissible forces) with equality constraints, or a proof that there is
// none.
//
// min 1/2 |x|^2 over the set and Q x = Q x_e. Dual: x = proj(y), y in the range of Q, maximise the concave
//   theta(y) = 1/2 |proj(y)|^2 - y'proj(y) + y'x_e,   grad theta = r = Q(x_e - proj(y)),
// by a semismooth Newton method (Newton matrix Q D Q, D = derivative of the projection at y) with line search. If there
// is no such point, theta is unbounded and r tends to the shortest Q(x_e - x) over the set, a Farkas certificate: r'x
// <= r'x_e - |r|^2 for all x of the set, while Q x = Q x_e requires r'x = r'x_e.
#pragma once

#include <slipstick/qp/force_set.h>
#include <slipstick/qp/mpgp.h>

namespace slipstick::qp
{
  template <typename Vector>
  struct FeasiblePoint
  {
    Status       status;      // converged; infeasible, with a certificate; otherwise neither was found
    Vector       x;           // within the set
    Vector       certificate; // infeasible: r in the range of Q, r'x_e > r'x for all x of the box; else Q(x_e - x)
    double       residual;    // |Q(x - x_e)| over the reference length max(|Q x_e|, |projection of 0 on the box|)
    bool         is_nearest;  // if converged: x is the point nearest to zero, not just a feasible one
    unsigned int newton_steps;
    unsigned int projections; // multiplications with Q
  };

  namespace detail
  {
    template <typename Vector, typename Problem, typename Set>
    class NearestPoint
    {
    public:
      NearestPoint(const Problem &problem_, const Vector &x_e, const Set &box_, const FeasiblePointOptions &options_)
        : problem(problem_)
        , reduction(problem.reduction())
        , box(box_)
        , options(options_)
        , Qx_e(x_e)
        , y(zero_like(x_e))
        , x(y)
        , r(y)
        , d(y)
        , p(y)
        , Ap(y)
        , residual(y)
      {
        project_range(x_e, Qx_e);
        project(box, x);
        const auto s =
          reduction.sum(std::array<double, 3>{{local_dot(Qx_e, Qx_e), local_dot(x, x), n_contradictions(box)}});
        reference = std::sqrt(std::max(s[0], s[1]));
        is_empty  = s[2] > 0;
      }

      FeasiblePoint<Vector> run()
      {
        Status status = is_empty ? Status::infeasible : newton();
        if (status != Status::converged && status != Status::infeasible)
          status = least_squares(status);
        const double scale = reference > 0 ? reference : 1.0;
        return {status, std::move(x), std::move(r), norm_r / scale, is_nearest, newton_steps, projections};
      }

    private:
      void project_range(const Vector &v, Vector &Qv)
      {
        problem.project_range(v, Qv);
        ++projections;
      }

      bool proves_infeasibility(const Vector &v) const
      {
        return is_farkas_certificate(box,
                                     v,
                                     Qx_e,
                                     options.certificate_radius * reference,
                                     options.certificate_margin,
                                     reduction);
      }

      // x = clip(y), r = Q(x_e - x)
      void update_residual()
      {
        std::copy(y.begin(), y.end(), x.begin());
        project(box, x);
        project_range(x, r);
        combine(1.0, Qx_e, -1.0, r);
        norm_r = norm(r, reduction);
      }

      Status newton()
      {
        StagnationWatch stagnates(options.stagnation_window, options.stagnation_progress);
        for (update_residual();; ++newton_steps, update_residual())
          {
            if (norm_r <= options.tolerance * reference)
              return Status::converged;
            if (proves_infeasibility(r))
              return Status::infeasible;
            if (stagnates(norm_r))
              return Status::stagnated;
            if (newton_steps == options.max_newton_steps)
              return Status::iteration_limit;
            find_direction();
            add(line_search(), d, y);
          }
      }

      // (Q D Q + regularization Q) d = r by conjugate gradients; every iterate d is an ascent direction.
      void find_direction()
      {
        const double tolerance =
          std::max(options.least_cg_tolerance, std::min(options.cg_tolerance, norm_r / reference)) * norm_r;
        set_zero(d);
        std::copy(r.begin(), r.end(), residual.begin());
        std::copy(r.begin(), r.end(), p.begin());
        double square = norm_r * norm_r;
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
        const bool ascends = dot(p, r, reduction) > 0;
        std::copy(ascends ? p.begin() : r.begin(), ascends ? p.end() : r.end(), d.begin());
      }

      // Ap = (Q D Q + regularization Q) p, p in the range of Q
      void multiply_newton_matrix()
      {
        std::copy(p.begin(), p.end(), x.begin());
        multiply_derivative(box, y, x);
        add(options.newton_regularization, p, x);
        project_range(x, Ap);
      }

      // d/dt theta(y + t d), decreasing in t
      double slope(const double t)
      {
        std::copy(y.begin(), y.end(), x.begin());
        add(t, d, x);
        project(box, x);
        return reduction.sum(std::array<double, 1>{{local_dot(d, Qx_e) - local_dot(d, x)}})[0];
      }

      // Step length t > 0 with |slope(t)| small relative to slope(0): expansion, then regula falsi (Illinois).
      double line_search()
      {
        double       low = 0, low_slope = slope(0), high = 1, high_slope = slope(high);
        const double accepted = options.line_search_slope * low_slope;
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

      // If Newton's method failed: minimises |Q(x - x_e)| over the set by MPGP. The minimum is positive if there is no
      // such point.
      Status least_squares(const Status failure)
      {
        is_nearest = false;
        // if there is no such point y diverges, and its rounding finally exceeds the required residual
        const bool is_far = norm(y, reduction) > options.certificate_radius * reference;
        std::copy(is_far ? Qx_e.begin() : y.begin(), is_far ? Qx_e.end() : y.end(), x.begin());
        project(box, x);
        if constexpr (std::is_same_v<Set, Box<Vector>>)
          minimize([this](const Vector &v, Vector &Qv) { project_range(v, Qv); }, 1., Qx_e, box);
        else if (reduction.min(are_cones(box) ? 1. : 0.) > 0)
          {
            // for the parts along the sides of the cones, which have bounds: S'Q S, |S|^2 <= 2
            const auto multiply = [this](const Vector &v, Vector &product) {
              std::copy(v.begin(), v.end(), p.begin());
              add_sides(box, p);
              project_range(p, product);
              add_sides_transposed(box, product);
            };
            std::copy(Qx_e.begin(), Qx_e.end(), d.begin());
            add_sides_transposed(box, d);
            resolve_into_sides(box, x);
            minimize(multiply, 2., d, bounds_of_sides(box));
            add_sides(box, x);
            project(box, x); // exactly
          }
        const Status status = examine(failure);
        return status == failure ? accelerated_gradients(failure) : status;
      }

      // Whether x is the point sought, or r the certificate.
      Status examine(const Status neither)
      {
        project_range(x, r);
        combine(1.0, Qx_e, -1.0, r); // Q(x_e - x)
        norm_r = norm(r, reduction);
        if (norm_r <= options.tolerance * reference)
          return Status::converged;
        return proves_infeasibility(r) ? Status::infeasible : neither;
      }

      // Minimises 1/2 x'Ax - x'b within bounds, down to rounding. A minimum exists: if rounding in the kernel of A
      // looks like a direction of unbounded descent, MPGP is restarted.
      template <typename Operator>
      void minimize(const Operator &A, const double norm_A, const Vector &b, const Box<Vector> &bounds)
      {
        const auto stop = [this](const Vector &, const double gP) { return gP <= options.least_gradient * reference; };
        Status     status = Status::infeasible;
        for (unsigned int k = 0; k < max_starts && status == Status::infeasible; ++k)
          {
            auto result =
              mpgp(A, norm_A, b, bounds, MpgpStart<Vector>{std::move(x)}, stop, options.fallback, reduction);
            x      = std::move(result.x);
            status = result.status;
          }
      }

      // As least_squares, by accelerated projected gradients from x (Nesterov 1983; restarts: O'Donoghue, Candes 2015),
      // if MPGP has failed. Q has norm 1.
      Status accelerated_gradients(const Status failure)
      {
        std::copy(x.begin(), x.end(), y.begin()); // the extrapolated point
        double momentum = 1;
        for (unsigned int k = 0; k < options.fallback.max_iterations; ++k)
          {
            project_range(y, r);
            combine(1.0, Qx_e, -1.0, r); // Q(x_e - y)
            std::copy(x.begin(), x.end(), p.begin());
            std::copy(y.begin(), y.end(), x.begin());
            add(1.0, r, x);
            project(box, x);
            combine(1.0, x, -1.0, p); // the step
            const double next    = 0.5 * (1 + std::sqrt(1 + 4 * momentum * momentum));
            const bool   ascends = dot(r, p, reduction) < 0;
            std::copy(x.begin(), x.end(), y.begin());
            if (!ascends)
              add((momentum - 1) / next, p, y);
            momentum = ascends ? 1 : next;
            if (k % check_interval != 0)
              continue;
            const Status status = examine(failure);
            if (status != failure)
              return status;
          }
        return failure;
      }

      static constexpr unsigned int check_interval = 10; // of the accelerated gradients
      static constexpr unsigned int max_starts     = 10; // of MPGP

      const Problem                                        &problem;
      decltype(std::declval<const Problem &>().reduction()) reduction;
      const Set                                            &box;
      const FeasiblePointOptions                           &options;

      Vector       Qx_e, y, x, r, d, p, Ap, residual;
      double       reference = 0, norm_r = 0;
      bool         is_empty = false, is_nearest = true;
      unsigned int newton_steps = 0, projections = 0;
    };
  } // namespace detail

  /// The point nearest to zero of the set (a Box, ForceSet) with Q x = Q x_e. Uses only `problem.project_range` and
  /// `problem.reduction`.
  /// status: infeasible with a certificate, see FeasiblePoint (without, if some lower > upper); iteration_limit or
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
