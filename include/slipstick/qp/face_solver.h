// The linear problem of a face: P(d - F x) = 0 on the free entries, while bounds, ties and G x remain as at the start.
// Directions of all earlier faces are used as far as this one admits them (direction_store.h).
//
// A face may be regularised: a compliance eps D of dependent entries, without strain at a given force, is added to F.
// If F is singular, the solution is then unique: the one nearest to that force (proximal point).
//
// Faces without ties are solved by conjugate gradients (Farhat, Crivelli, Roux 1994, with full orthogonalisation). Ties
// make the operator unsymmetric; then generalised conjugate residuals are used (Eisenstat, Elman, Schultz 1983).
#pragma once

#include <slipstick/qp/direction_store.h>
#include <slipstick/qp/kernels.h>
#include <slipstick/qp/options.h>
#include <slipstick/qp/pressure_bounds.h>
#include <slipstick/qp/recycled.h>
#include <slipstick/qp/types.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

namespace slipstick::qp
{
  template <typename Vector>
  struct FaceSolution
  {
    Status status;
    Vector x, product; // F x
    double residual;   // weighted |P(d - F x)|, of the regularised problem
    double error;      // of the product by rounding: an estimate in the norm of the residual
    Counts counts;
  };

  /// Solves a face with directions from the store, and adds new ones to it.
  template <typename Vector, typename Face>
  class FaceSolver
  {
  public:
    /// @param face, d, store, options are kept by reference. @param conditions as in admissible_combinations().
    /// @param turns_ of the face; their compliances C are added to F.
    /// @param regularization_ eps >= 0; > 0 only with dependent_compliances() of the face
    template <typename Conditions>
    FaceSolver(const Face              &face_,
               const Vector            &d_,
               DirectionStore<Vector>  &store_,
               const Conditions        &conditions,
               const FaceSolverOptions &options_,
               std::vector<Turn>        turns_          = {},
               const double             regularization_ = 0)
      : face(face_)
      , given(d_)
      , store(store_)
      , options(options_)
      , turns(std::move(turns_))
      , reduction(face_.reduction())
      , regularization(regularization_)
      , is_turned(reduction.min(turns.empty() ? 1. : 0.) < 1)
      , has_compliance(is_turned || regularization > 0)
      , weights(residual_weights(face_, 0))
      , D(dependent_compliances(face_, 0))
      , recycled(store_, admissible_combinations(store_, conditions, reduction))
      , n_recycled(store_.size())
      , d(d_)
      , x(d_)
      , Fx(d_)
      , r(d_)
      , w(d_)
    {
      if (is_turned && recycled.size() < n_recycled)
        for (std::size_t j = 0; j < n_recycled; ++j)
          violations.push_back(conditions(store[j].p));
    }

    /// @param product F x. @param error_of_product by rounding, weighted. @param center force at which eps D has no
    /// strain.
    /// @return the weighted residual |P(d - F x - eps D (x - center))|.
    double start(Vector x_, Vector product, const double error_of_product, const Vector &center)
    {
      x  = std::move(x_);
      Fx = std::move(product);
      d  = given;
      if (regularization > 0)
        add_diagonal(regularization, *D, center, d);
      error = error_of_product;
      update_residual();
      return norm_r;
    }

    /// The same without regularisation.
    double start(Vector x_, Vector product, const double error_of_product = 0)
    {
      return start(std::move(x_), std::move(product), error_of_product, given);
    }

    /// Conjugate gradients from the start until the weighted residual is at most @p target. For faces without ties.
    FaceSolution<Vector> solve_symmetric(const double target)
    {
      std::optional<PivotedCholesky> known;
      if (recycled.size() > 0 && norm_r > target)
        {
          if (is_turned)
            known.emplace(recycled.factor(energies_with_compliance()));
          else
            known.emplace(recycled.factor(
              [this](const std::size_t i, const std::size_t j) { return store.energy(i, j, regularization); }));
          for (unsigned int pass = 0; pass < 2 && norm_r > target; ++pass)
            move(recycled.coefficients(known->solve(recycled.combined(dots(r, &Direction::p)))));
        }
      std::vector<std::pair<Vector, Vector>> own; // F-orthogonal, with products
      std::vector<double>                    energies;
      double                                 largest = 0;
      while (norm_r > target || !is_true(target))
        {
          if (counts.cg_steps == options.max_iterations)
            return ended(Status::iteration_limit);
          Vector p = preconditioned(r);
          if (known)
            {
              const auto c = recycled.coefficients(known->solve(recycled.combined(dots_with_products(p))));
              recycled.add_combination(
                -1.,
                c,
                [this](const std::size_t j) -> const Vector & { return store[j].p; },
                p);
            }
          std::vector<double> along;
          for (const auto &[q, Fq] : own)
            along.push_back(local_dot(p, Fq));
          sum_all(along, reduction);
          for (std::size_t j = 0; j < own.size(); ++j)
            add(-along[j] / energies[j], own[j].first, p);
          Vector Fp(p);
          multiply(p, Fp);
          Vector Ap(Fp); // (F + C) p
          add_compliances(p, Ap);
          const auto [pr, pAp, pFp, pp, squares] = reduction.sum(std::array<double, 5>{
            {local_dot(p, r), local_dot(p, Ap), local_dot(p, Fp), local_dot(p, p), local_squares(weights, p, Fp)}});
          if (!std::isfinite(pr) || !std::isfinite(pAp) || !(pr > 0))
            return ended(Status::stagnated);
          if (pAp <= options.smallest_curvature * largest * pp)
            return ended(Status::infeasible);
          largest = std::max(largest, pFp / pp); // without C, which may be 1e8 times as large
          add(pr / pAp, p, x);
          add(pr / pAp, Fp, Fx);
          const double error_of_own = rounding_of_product(squares), before = norm_r;
          error = std::hypot(error, pr / pAp * error_of_own);
          update_residual();
          ++counts.cg_steps;
          own.emplace_back(p, std::move(Ap));
          energies.push_back(pAp);
          keep(std::move(p), std::move(Fp), error_of_own);
          if (stagnates(before))
            return ended(Status::stagnated);
        }
      return ended(Status::converged);
    }

    /// The same by generalised conjugate residuals, for all faces.
    FaceSolution<Vector> solve_unsymmetric(const double target)
    {
      std::vector<Vector>            images;        // weighted P (F + C) p of the directions of the store
      std::optional<PivotedCholesky> known, nearly; // for admissible combinations; for all directions
      if (n_recycled > 0 && norm_r > target)
        {
          for (std::size_t j = 0; j < n_recycled; ++j)
            images.push_back(image(store[j].p, store[j].Fp));
          const SmallSymmetric all = gram(images);
          if (recycled.size() > 0)
            known.emplace(recycled.factor([&all](const std::size_t i, const std::size_t j) { return all(i, j); }));
          for (unsigned int pass = 0; known && pass < 2 && norm_r > target; ++pass)
            move(recycled.coefficients(known->solve(recycled.combined(dots(weighted(r), images)))));
          if (!violations.empty())
            nearly.emplace(regularized(all, gram(violations)));
        }
      struct Own
      {
        Vector p, Fp, q;
        double error; // of Fp
      };
      std::vector<Own> own; // q orthonormal
      while (norm_r > target || !is_true(target))
        {
          if (counts.cg_steps == options.max_iterations)
            return ended(Status::iteration_limit);
          Vector p = nearly ? preconditioned(*nearly, images) : preconditioned(r);
          Vector Fp(p);
          multiply(p, Fp);
          Vector       q       = image(p, Fp);
          const auto   made_of = reduction.sum(std::array<double, 2>{{local_dot(q, q), local_squares(weights, p, Fp)}});
          const double first   = std::sqrt(made_of[0]);
          double       error_of_own = rounding_of_product(made_of[1]);
          for (unsigned int pass = 0; pass < 2; ++pass) // twice is enough
            {
              if (known)
                {
                  const auto c = recycled.coefficients(known->solve(recycled.combined(dots(q, images))));
                  error_of_own = std::hypot(error_of_own, error_of(c));
                  recycled.add_combination(
                    -1.,
                    c,
                    [this](const std::size_t j) -> const Vector & { return store[j].p; },
                    p);
                  recycled.add_combination(
                    -1.,
                    c,
                    [this](const std::size_t j) -> const Vector & { return store[j].Fp; },
                    Fp);
                  recycled.add_combination(
                    -1.,
                    c,
                    [&images](const std::size_t j) -> const Vector & { return images[j]; },
                    q);
                }
              std::vector<double> along;
              for (const Own &other : own)
                along.push_back(local_dot(q, other.q));
              sum_all(along, reduction);
              for (std::size_t j = 0; j < own.size(); ++j)
                {
                  add(-along[j], own[j].p, p);
                  add(-along[j], own[j].Fp, Fp);
                  add(-along[j], own[j].q, q);
                  error_of_own = std::hypot(error_of_own, along[j] * own[j].error);
                }
            }
          const double length = norm(q, reduction);
          if (!(length > options.rounding * first))
            return ended(Status::stagnated);
          for (Vector *v : {&p, &Fp, &q})
            combine(1. / length, *v, 0., *v);
          const double rq = dot(weighted(r), q, reduction);
          add(rq, p, x);
          add(rq, Fp, Fx);
          error_of_own /= length;
          error               = std::hypot(error, rq * error_of_own);
          const double before = norm_r;
          update_residual();
          ++counts.cg_steps;
          own.push_back({p, Fp, std::move(q), error_of_own});
          keep(std::move(p), std::move(Fp), error_of_own);
          if (stagnates(before))
            return ended(Status::stagnated);
        }
      return ended(Status::converged);
    }

  private:
    using Direction = typename DirectionStore<Vector>::Direction;

    struct Made
    {
      Vector p, Fp;
      double error; // of Fp
    };

    FaceSolution<Vector> ended(const Status status)
    {
      for (auto &[p, Fp, error_of_Fp] : made)
        store.push(std::move(p), std::move(Fp), error_of_Fp, D, reduction);
      return {status, std::move(x), std::move(Fx), norm_r, error, counts};
    }

    // Moves x along directions of the store.
    void move(const std::vector<double> &coefficients)
    {
      recycled.add_combination(
        1.,
        coefficients,
        [this](const std::size_t j) -> const Vector & { return store[j].p; },
        x);
      recycled.add_combination(
        1.,
        coefficients,
        [this](const std::size_t j) -> const Vector & { return store[j].Fp; },
        Fx);
      error = std::hypot(error, error_of(coefficients));
      update_residual();
    }

    // Rounding error of the products of a combination of directions of the store.
    double error_of(const std::vector<double> &coefficients) const
    {
      double square = 0;
      for (std::size_t j = 0; j < n_recycled; ++j)
        square += coefficients[j] * coefficients[j] * store[j].error * store[j].error;
      return std::sqrt(square);
    }

    // Whether the residual is that of F x, as accurately as the target requires. If not, F x is computed anew (residual
    // replacement: van der Vorst, Ye 2000), provided that this is more accurate.
    bool is_true(const double target)
    {
      const double trusted = options.accuracy * target;
      if (error <= trusted || is_replaced)
        return true;
      const double least =
        rounding_of_product(reduction.sum(std::array<double, 1>{{local_squares(weights, x, Fx)}})[0]);
      if (!(least <= trusted))
        return true;
      is_replaced = true;
      multiply(x, Fx);
      error = least;
      update_residual();
      return norm_r <= target;
    }

    // Directions are stored at the end; until then the combinations refer to the numbering of the store.
    void keep(Vector p, Vector Fp, const double error_of_Fp)
    {
      made.push_back({std::move(p), std::move(Fp), error_of_Fp});
    }

    bool stagnates(const double before)
    {
      n_stuck = norm_r > options.progress * before ? n_stuck + 1 : 0;
      return !std::isfinite(norm_r) || n_stuck >= options.patience;
    }

    void multiply(const Vector &v, Vector &Fv)
    {
      face.multiply(v, Fv);
      ++counts.hessian_multiplications;
    }

    // y += (C + eps D) v
    void add_compliances(const Vector &v, Vector &y) const
    {
      add_compliance(turns, v, y);
      if (regularization > 0)
        add_diagonal(regularization, *D, v, y);
    }

    // r = P(d - (F + C + eps D) x), where d contains the term added by start()
    void update_residual()
    {
      std::copy(d.begin(), d.end(), r.begin());
      add(-1.0, Fx, r);
      if (has_compliance)
        {
          set_zero(w);
          add_compliances(x, w);
          add(-1.0, w, r);
        }
      face.project_range(r, w);
      add(-1.0, w, r);
      norm_r = std::sqrt(reduction.sum(std::array<double, 1>{{squared(r)}})[0]);
    }

    // Of the owned entries, in the norm of the residual.
    double squared(const Vector &v) const
    {
      if (turns.empty())
        return local_weighted_dot(weights, v, v);
      const Vector in_norm = weighted(v);
      return local_dot(in_norm, in_norm);
    }

    Vector preconditioned(const Vector &residual)
    {
      Vector p(residual);
      face.precondition(residual, p);
      ++counts.preconditioner_applications;
      face.project_kernel(p);
      return p;
    }

    // Factors of the least squares problem for all directions of the store, in which violations of the conditions of
    // the face count as residuals.
    PivotedCholesky regularized(SmallSymmetric images, const SmallSymmetric &of_violations) const
    {
      std::vector<double> sizes;
      for (std::size_t i = 0; i < n_recycled; ++i)
        {
          for (std::size_t j = 0; j < n_recycled; ++j)
            images(i, j) += options.violation_weight * options.violation_weight * of_violations(i, j);
          sizes.push_back(images(i, i));
        }
      return PivotedCholesky(std::move(images), sizes, detail::dependent_direction);
    }

    // The combination of directions of the store that reduces the residual most, moved onto the face (where the stored
    // products are only approximate), plus M times the residual that it leaves.
    Vector preconditioned(const PivotedCholesky &nearly, const std::vector<Vector> &images)
    {
      Vector     left = weighted(r), p = zero_like(r);
      const auto c = nearly.solve(dots(left, images));
      for (std::size_t j = 0; j < n_recycled; ++j)
        {
          add(-c[j], images[j], left);
          add(c[j], store[j].p, p);
        }
      unweight(left);
      face.clear_held(p);
      add(1., preconditioned(left), p);
      face.project_kernel(p);
      return p;
    }

    // In the norm of the residual: entries are turned, and those across a slipping force count relative to their own
    // compliance, since the force follows the slip.
    Vector weighted(const Vector &v) const
    {
      Vector result(v);
      turn(turns, result);
      for (std::size_t i = 0; i < local_size(v); ++i)
        result.begin()[i] *= weight(i);
      for (const Turn &of : turns)
        result.begin()[of.second] *= of.softness(weight(of.second));
      return result;
    }

    // The inverse.
    void unweight(Vector &v) const
    {
      for (const Turn &of : turns)
        v.begin()[of.second] /= of.softness(weight(of.second));
      for (std::size_t i = 0; i < local_size(v); ++i)
        v.begin()[i] /= weight(i);
      turn_back(turns, v);
    }

    double weight(const std::size_t i) const
    {
      return weights ? weights[i] : 1.;
    }

    // weighted P (F + C + eps D) p
    Vector image(const Vector &p, const Vector &Fp)
    {
      Vector q(Fp);
      add_compliances(p, q);
      face.project_range(static_cast<const Vector &>(q), w);
      add(-1.0, w, q);
      return weighted(q);
    }

    std::vector<double> dots(const Vector &v, Vector Direction::*part) const
    {
      std::vector<double> result;
      for (std::size_t j = 0; j < n_recycled; ++j)
        result.push_back(local_dot(v, store[j].*part));
      sum_all(result, reduction);
      return result;
    }

    // v'(F + C + eps D) p_j
    std::vector<double> dots_with_products(const Vector &v) const
    {
      if (!has_compliance)
        return dots(v, &Direction::Fp);
      Vector Cv = zero_like(v);
      add_compliances(v, Cv);
      std::vector<double> result;
      for (std::size_t j = 0; j < n_recycled; ++j)
        result.push_back(local_dot(v, store[j].Fp) + local_dot(Cv, store[j].p));
      sum_all(result, reduction);
      return result;
    }

    // p_i'(F + C + eps D) p_j of the directions of the store
    auto energies_with_compliance() const
    {
      std::vector<double> products;
      for (std::size_t i = 0; i < n_recycled; ++i)
        {
          Vector Cp = zero_like(store[i].p);
          add_compliance(turns, store[i].p, Cp);
          for (std::size_t j = 0; j <= i; ++j)
            products.push_back(local_dot(Cp, store[j].p));
        }
      sum_all(products, reduction);
      SmallSymmetric result(n_recycled);
      std::size_t    next = 0;
      for (std::size_t i = 0; i < n_recycled; ++i)
        for (std::size_t j = 0; j <= i; ++j)
          result(i, j) = result(j, i) = store.energy(i, j, regularization) + products[next++];
      return [result](const std::size_t i, const std::size_t j) { return result(i, j); };
    }

    std::vector<double> dots(const Vector &v, const std::vector<Vector> &images) const
    {
      std::vector<double> result;
      for (const Vector &q : images)
        result.push_back(local_dot(v, q));
      sum_all(result, reduction);
      return result;
    }

    // v_i'v_j of all pairs of distributed vectors
    template <typename Any>
    SmallSymmetric gram(const std::vector<Any> &vectors) const
    {
      std::vector<double> products;
      for (std::size_t i = 0; i < vectors.size(); ++i)
        for (std::size_t j = 0; j <= i; ++j)
          products.push_back(local_dot(vectors[i], vectors[j]));
      sum_all(products, reduction);
      SmallSymmetric result(vectors.size());
      std::size_t    next = 0;
      for (std::size_t i = 0; i < vectors.size(); ++i)
        for (std::size_t j = 0; j <= i; ++j)
          result(i, j) = result(j, i) = products[next++];
      return result;
    }

    using ReductionType = std::decay_t<decltype(std::declval<Face>().reduction())>;

    const Face                      &face;
    const Vector                    &given;
    DirectionStore<Vector>          &store;
    const FaceSolverOptions         &options;
    const std::vector<Turn>          turns;
    const ReductionType             &reduction;
    const double                     regularization;
    const bool                       is_turned; // on any process
    const bool                       has_compliance;
    const double                    *weights;
    const std::vector<double> *const D; // null: none
    detail::Recycled<Vector>         recycled;
    const std::size_t                n_recycled;

    Vector            d, x, Fx, r, w;
    double            norm_r      = 0;
    double            error       = 0; // of Fx
    bool              is_replaced = false;
    unsigned int      n_stuck     = 0;
    std::vector<Made> made;

    std::vector<std::vector<double>> violations; // of the conditions of a turned face, for the directions of the store
    Counts                           counts;
  };
} // namespace slipstick::qp
