// GCR: generalised conjugate residuals on a face whose entries are tied to each other, so that the operator is not
// symmetric. Eisenstat, Elman, Schultz 1983; with full orthogonalisation the residuals are those of GMRES.
//
// Besides what PCPG needs of a problem: `project_kernel(p)` moves the free entries of p by the least that makes G p = 0
// and sets the tied ones accordingly.
#pragma once

#include <slipstick/qp/kernels.h>
#include <slipstick/qp/options.h>
#include <slipstick/qp/types.h>

#include <memory>
#include <utility>
#include <vector>

namespace slipstick::qp
{
  /// Directions p with F p and q = P F p, the q orthonormal. Kept from one solve to the next they solve for what lies in
  /// their span without a multiplication, as long as F, P, the free entries and their ties stay.
  template <typename Vector>
  class ResidualHistory
  {
  public:
    bool empty() const
    {
      return directions.empty();
    }

    /// x += z, Fx += F z with the z of the span that makes r - P F z least.
    template <typename Reduction>
    void solve(const Vector &r, Vector &x, Vector &Fx, const Reduction &reduction) const
    {
      batches(r, reduction, [&](const Direction &direction, const double rq) {
        add(rq, direction.p, x);
        add(rq, direction.Fp, Fx);
      });
    }

    /// q -= the part of q in the span; p and Fp with it.
    template <typename Reduction>
    void orthogonalize(Vector &p, Vector &Fp, Vector &q, const Reduction &reduction) const
    {
      for (unsigned int pass = 0; pass < 2; ++pass) // twice is enough
        batches(Vector(q), reduction, [&](const Direction &direction, const double qq) {
          add(-qq, direction.p, p);
          add(-qq, direction.Fp, Fp);
          add(-qq, direction.q, q);
        });
    }

    void push(Vector p, Vector Fp, Vector q)
    {
      directions.push_back({std::move(p), std::move(Fp), std::move(q)});
    }

  private:
    struct Direction
    {
      Vector p, Fp, q;
    };

    static constexpr std::size_t batch = 32; // scalars of one reduction: latency against wasted length

    /// action(direction, v'q) for all directions.
    template <typename Reduction, typename Action>
    void batches(const Vector &v, const Reduction &reduction, const Action &action) const
    {
      for (std::size_t first = 0; first < directions.size(); first += batch)
        {
          const std::size_t         n = std::min(batch, directions.size() - first);
          std::array<double, batch> vq{};
          for (std::size_t j = 0; j < n; ++j)
            vq[j] = local_dot(v, directions[first + j].q);
          vq = reduction.sum(vq);
          for (std::size_t j = 0; j < n; ++j)
            action(directions[first + j], vq[j]);
        }
    }

    std::vector<Direction> directions;
  };

  template <typename Vector>
  struct GcrResult
  {
    Status status;
    Vector x;
    Vector product;        // F x
    Counts counts;         // cg_steps, hessian_multiplications, preconditioner_applications
    double first_step = 0; // along the preconditioned residual of the start
  };

  /// Find x with P(b - F x) = 0 on the free entries, ties and G x as in the start, until |P(b - F x)| is at most
  /// goal.tolerance times goal.reference (which must be given). `product` = F x of the start.
  /// status: stagnated when a step does not lower the residual by the part that options ask for.
  template <typename Vector, typename Face, typename Preconditioner>
  GcrResult<Vector> gcr(const Face              &face,
                        const Vector            &b,
                        Vector                   x,
                        Vector                   product,
                        ResidualHistory<Vector> &history,
                        const Goal              &goal,
                        const GcrOptions        &options,
                        const Preconditioner    &precondition)
  {
    const auto &reduction = face.reduction();
    const auto  norm      = [&reduction](const Vector &v) { return qp::norm(v, reduction); };
    const auto  weigh     = [weights = residual_weights(face, 0)](Vector &v) { // residuals are kept with their weights
      if (weights)
        for (std::size_t i = 0; i < local_size(v); ++i)
          v.begin()[i] *= weights[i];
    };
    Vector     r(b), weighted(b), w(b);
    Counts     counts;
    const auto update_residual = [&] {
      std::copy(b.begin(), b.end(), r.begin());
      add(-1.0, product, r);
      face.project_range(r, w);
      add(-1.0, w, r);
      std::copy(r.begin(), r.end(), weighted.begin());
      weigh(weighted);
      return norm(weighted);
    };
    const auto take_off = [weights = residual_weights(face, 0), &r, &weighted, &norm](const double  rq,
                                                                                      const Vector &q) {
      add(-rq, q, weighted);
      for (std::size_t i = 0; i < local_size(r); ++i)
        r.begin()[i] = weights ? weighted.begin()[i] / weights[i] : weighted.begin()[i];
      return norm(weighted);
    };
    double norm_r = update_residual();
    if (!history.empty())
      {
        history.solve(weighted, x, product, reduction);
        norm_r = update_residual();
      }
    const double target     = goal.tolerance * goal.reference;
    unsigned int stuck      = 0;
    double       first_step = 0;
    const auto   ended_with = [&](const Status status) {
      return GcrResult<Vector>{status, std::move(x), std::move(product), counts, first_step};
    };
    for (unsigned int iteration = 0;; ++iteration)
      {
        if (norm_r <= target)
          return ended_with(Status::converged);
        if (iteration == options.max_iterations)
          return ended_with(Status::iteration_limit);
        Vector p(r), q(r), Fp(r);
        precondition(static_cast<const Vector &>(r), p);
        ++counts.preconditioner_applications;
        face.project_kernel(p);
        face.multiply(p, Fp);
        ++counts.hessian_multiplications;
        std::copy(Fp.begin(), Fp.end(), q.begin());
        face.project_range(Fp, w);
        add(-1.0, w, q);
        weigh(q);
        const double before = norm(q);
        history.orthogonalize(p, Fp, q, reduction);
        const double length = norm(q);
        if (!(length > options.rounding * before))
          return ended_with(Status::stagnated);
        for (Vector *v : {&p, &Fp, &q})
          combine(1. / length, *v, 0., *v);
        const double rq = reduction.sum(std::array<double, 1>{{local_dot(weighted, q)}})[0];
        if (counts.cg_steps == 0)
          first_step = rq / length;
        add(rq, p, x);
        add(rq, Fp, product);
        ++counts.cg_steps;
        const double previous = norm_r;
        norm_r                = take_off(rq, q);
        if (norm_r <= target) // up to rounding
          norm_r = update_residual();
        history.push(std::move(p), std::move(Fp), std::move(q));
        stuck = norm_r > options.progress * previous ? stuck + 1 : 0;
        if (!std::isfinite(norm_r) || stuck >= options.patience)
          return ended_with(Status::stagnated);
      }
  }
} // namespace slipstick::qp
