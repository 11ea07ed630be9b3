// PCPG: preconditioned conjugate gradients in the kernel of Q, for min 1/2 x'Fx - x'b without bounds.
// Farhat, Crivelli, Roux 1994.
//
// A preconditioned problem may have `project_kernel(p)`, which makes G p = 0, in addition to `project_range`, which
// then gives some range part G'a of a residual: this allows oblique projections, each the transpose of the other.
// `residual_weights()` weights the entries of residuals in their norms.
#pragma once

#include <slipstick/qp/kernels.h>
#include <slipstick/qp/options.h>
#include <slipstick/qp/stagnation.h>
#include <slipstick/qp/types.h>

#include <memory>
#include <optional>
#include <type_traits>
#include <utility>
#include <vector>

namespace slipstick::qp
{
  template <typename Vector>
  struct PcpgResult
  {
    Status status;
    Vector x;                 // the start plus a vector in the range of P
    Vector product;           // F x
    Vector residual;          // P(b - F x)
    double relative_residual; // |P(b - F x)| over the reference of the goal
    double reference;
    Counts counts; // cg_steps, hessian_multiplications, preconditioner_applications
  };

  /// y = r; not counted as a preconditioner.
  struct NoPreconditioner
  {};

  /// F-orthogonal directions p with F p and p'Fp. Kept from one solve to the next, they give the solution in their span
  /// without a multiplication, as long as F, P and the free entries are the same.
  template <typename Vector>
  class DirectionHistory
  {
  public:
    explicit DirectionHistory(const bool keeps_all_ = true)
      : keeps_all(keeps_all_)
    {}

    bool empty() const
    {
      return directions.empty();
    }

    /// x += z, Fx += F z with the z of the span that makes b - F(x + z) orthogonal to it; r = P(b - F x).
    template <typename Reduction>
    void solve(const Vector &r, Vector &x, Vector &Fx, const Reduction &reduction) const
    {
      for (std::size_t first = 0; first < directions.size(); first += batch)
        {
          const std::size_t         n = std::min(batch, directions.size() - first);
          std::array<double, batch> rq{};
          for (std::size_t j = 0; j < n; ++j)
            rq[j] = local_dot(r, directions[first + j].q);
          rq = reduction.sum(rq);
          for (std::size_t j = 0; j < n; ++j)
            {
              add(rq[j] / directions[first + j].qFq, directions[first + j].q, x);
              add(rq[j] / directions[first + j].qFq, directions[first + j].Fq, Fx);
            }
        }
    }

    void push(Vector p, Vector Fp, const double pFp)
    {
      if (!keeps_all)
        directions.clear();
      directions.push_back({std::move(p), std::move(Fp), pFp});
    }

    /// p -= sum_j (p'F q_j / q_j'F q_j) q_j. One reduction for a batch of directions.
    template <typename Reduction>
    void orthogonalize(Vector &p, const Reduction &reduction) const
    {
      const Vector z(p);
      for (std::size_t first = 0; first < directions.size(); first += batch)
        {
          const std::size_t         n = std::min(batch, directions.size() - first);
          std::array<double, batch> zFq{};
          for (std::size_t j = 0; j < n; ++j)
            zFq[j] = local_dot(z, directions[first + j].Fq);
          zFq = reduction.sum(zFq);
          for (std::size_t j = 0; j < n; ++j)
            add(-zFq[j] / directions[first + j].qFq, directions[first + j].q, p);
        }
    }

  private:
    struct Direction
    {
      Vector q, Fq;
      double qFq;
    };

    static constexpr std::size_t batch = 32; // scalars per reduction: compromise between latency and message length

    const bool             keeps_all;
    std::vector<Direction> directions;
  };

  /// Start of PCPG. The product F x, if known, saves a multiplication.
  template <typename Vector>
  struct PcpgStart
  {
    Vector                x;
    std::optional<Vector> product = std::nullopt;

    /// Directions of earlier solves with the same F and P, to which this solve adds its own; full reorthogonalisation
    /// only.
    std::shared_ptr<DirectionHistory<Vector>> history = nullptr;
  };

  namespace detail
  {
    template <typename Vector, typename Problem, typename Preconditioner>
    class Pcpg
    {
    public:
      Pcpg(const Problem        &problem_,
           const Vector         &b_,
           PcpgStart<Vector>     start,
           const Goal           &goal,
           const PcpgOptions    &options_,
           const Preconditioner &preconditioner_,
           const Observer       &observer_)
        : problem(problem_)
        , b(b_)
        , options(options_)
        , preconditioner(preconditioner_)
        , observer(observer_)
        , x(std::move(start.x))
        , Fx(start.product ? std::move(*start.product) : zero_like(b))
        , r(b)
        , w(b)
        , directions(start.history ? start.history
                                   : std::make_shared<DirectionHistory<Vector>>(keeps_all_directions(options_)))
      {
        const auto s = problem.reduction().sum(std::array<double, 2>{{local_dot(b, b), local_dot(x, x)}});
        if (!start.product && s[1] > 0)
          multiply(x, Fx);
        update_residual();
        if (!directions->empty())
          {
            directions->solve(r, x, Fx, problem.reduction());
            update_residual();
          }
        norm_b    = std::sqrt(s[0]);
        reference = goal.reference > 0 ? goal.reference : norm_b > 0 ? norm_b : norm_Fx > 0 ? norm_Fx : 1.0;
        target    = goal.tolerance * reference;
      }

      PcpgResult<Vector> run()
      {
        const Status status = iterate();
        return {status, std::move(x), std::move(Fx), std::move(r), norm_r / reference, reference, counts};
      }

    private:
      static constexpr bool is_preconditioned = !std::is_same_v<Preconditioner, NoPreconditioner>;

      static bool keeps_all_directions(const PcpgOptions &options)
      {
        return options.reorthogonalization == Reorthogonalization::full ||
               (options.reorthogonalization == Reorthogonalization::automatic && is_preconditioned);
      }

      Status iterate()
      {
        StagnationWatch stagnates(options.stagnation_window, options.stagnation_progress);
        for (unsigned int iteration = 0;; ++iteration)
          {
            if (norm_r <= target)
              return Status::converged;
            if (stagnates(norm_r) || norm_r <= noise())
              return Status::stagnated;
            if (iteration == options.max_iterations)
              return Status::iteration_limit;
            if (const auto outcome = step())
              return *outcome;
          }
      }

      double noise() const
      {
        return options.rounding * (norm_Fx + norm_b);
      }

      void multiply(const Vector &v, Vector &Fv)
      {
        problem.multiply(v, Fv);
        ++counts.hessian_multiplications;
      }

      // z = P M r
      Vector new_direction()
      {
        Vector z(r);
        if constexpr (is_preconditioned)
          {
            preconditioner(static_cast<const Vector &>(r), z);
            ++counts.preconditioner_applications;
            project_kernel(problem, z, w, 0);
          }
        directions->orthogonalize(z, problem.reduction());
        return z;
      }

      // nullopt: continue.
      std::optional<Status> step()
      {
        Vector p = new_direction();
        Vector Fp(p);
        multiply(p, Fp);
        const auto [pr, pFp, pp] =
          problem.reduction().sum(std::array<double, 3>{{local_dot(p, r), local_dot(p, Fp), local_dot(p, p)}});
        if (!std::isfinite(pr) || !std::isfinite(pFp) || pr <= noise() * std::sqrt(pp))
          return Status::stagnated;
        if (pFp <= options.smallest_curvature * largest_curvature * pp)
          return Status::infeasible;
        largest_curvature = std::max(largest_curvature, pFp / pp);
        add(pr / pFp, p, x);
        add(pr / pFp, Fp, Fx);
        update_residual();
        directions->push(std::move(p), std::move(Fp), pFp);
        ++counts.cg_steps;
        if (observer)
          observer({counts.cg_steps, counts.hessian_multiplications, norm_r / reference, 0.0, 0, 0});
        return {};
      }

      // r = P(b - F x)
      void update_residual()
      {
        std::copy(b.begin(), b.end(), r.begin());
        add(-1.0, Fx, r);
        problem.project_range(r, w);
        add(-1.0, w, r);
        const auto s = problem.reduction().sum(
          std::array<double, 2>{{local_weighted_dot(residual_weights(problem, 0), r, r), local_dot(Fx, Fx)}});
        norm_r  = std::sqrt(s[0]);
        norm_Fx = std::sqrt(s[1]);
      }

      const Problem        &problem;
      const Vector         &b;
      const PcpgOptions    &options;
      const Preconditioner &preconditioner;
      const Observer       &observer;

      Vector                                    x, Fx, r, w;
      std::shared_ptr<DirectionHistory<Vector>> directions;
      double                                    norm_b = 0, norm_r = 0, norm_Fx = 0;
      double                                    reference = 0, target = 0, largest_curvature = 0;
      Counts                                    counts;
    };
  } // namespace detail

  /// Minimises 1/2 x'Fx - x'b over start + range of P until |P(b - F x)| <= goal.tolerance times goal.reference
  /// (default |b|). Q x keeps its initial value; b need not be in the range of P. `preconditioner(r, y)`: y = M r,
  /// symmetric positive (semi)definite. From x = 0, or from a start with product, there is no multiplication before the
  /// first step. Full reorthogonalisation stores two vectors per step.
  /// The observer is called after every step, on every process.
  /// status: infeasible if F is singular along a direction of descent (unbounded from below).
  /// @code
  /// using Vector = std::vector<double>;
  /// struct Problem // F = diag(1, 3), G = (1, 1) / sqrt(2)
  /// {
  ///   void multiply(const Vector &x, Vector &y) const { y = {x[0], 3 * x[1]}; }
  ///   void project_range(const Vector &x, Vector &y) const { y.assign(2, (x[0] + x[1]) / 2); }
  ///   SerialReduction reduction() const { return {}; }
  /// };
  /// const auto best = pcpg(Problem(), Vector{2, 0}, PcpgStart<Vector>{Vector(2, 0.)}, 1e-12);
  /// assert(best.status == Status::converged);
  /// assert(std::abs(best.x[0] - 0.5) < 1e-12 && std::abs(best.x[1] + 0.5) < 1e-12);
  /// @endcode
  template <typename Vector, typename Problem, typename Preconditioner = NoPreconditioner>
  PcpgResult<Vector> pcpg(const Problem        &problem,
                          const Vector         &b,
                          PcpgStart<Vector>     start,
                          const Goal           &goal,
                          const PcpgOptions    &options        = {},
                          const Preconditioner &preconditioner = {},
                          const Observer       &observer       = {})
  {
    using Solver = detail::Pcpg<Vector, Problem, Preconditioner>;
    return Solver(problem, b, std::move(start), goal, options, preconditioner, observer).run();
  }
} // namespace slipstick::qp
