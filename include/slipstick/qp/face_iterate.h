// A face problem, the directions that it admits, and its present point: what both methods of face_solver.h share.
#pragma once

#include <slipstick/qp/direction_store.h>
#include <slipstick/qp/kernels.h>
#include <slipstick/qp/options.h>
#include <slipstick/qp/pressure_bounds.h>
#include <slipstick/qp/recycled.h>
#include <slipstick/qp/types.h>

#include <algorithm>
#include <cmath>
#include <type_traits>
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

  namespace detail
  {
    /// Parameters and notation: FaceSolver.
    template <typename Vector, typename Face>
    class FaceIterate
    {
    public:
      using Reduction = std::decay_t<decltype(std::declval<Face>().reduction())>;
      using Direction = typename DirectionStore<Vector>::Direction;

      template <typename Conditions>
      FaceIterate(const Face              &face_,
                  const Vector            &d_,
                  DirectionStore<Vector>  &store_,
                  const Conditions        &conditions,
                  const FaceSolverOptions &options_,
                  std::vector<Turn>        turns_,
                  const double             regularization_)
        : face(face_)
        , store(store_)
        , options(options_)
        , turns(std::move(turns_))
        , reduction(face_.reduction())
        , regularization(regularization_)
        , is_turned(reduction.min(turns.empty() ? 1. : 0.) < 1)
        , has_compliance(is_turned || regularization > 0)
        , recycled(store_, admissible_combinations(store_, conditions, reduction))
        , n_recycled(store_.size())
        , given(d_)
        , weights(residual_weights(face_, 0))
        , D(dependent_compliances(face_, 0))
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

      void start(Vector x_, Vector product, const double error_of_product, const Vector &center)
      {
        x  = std::move(x_);
        Fx = std::move(product);
        d  = given;
        if (regularization > 0)
          add_diagonal(regularization, *D, center, d);
        error = error_of_product;
        update_residual();
      }

      void start(Vector x_, Vector product, const double error_of_product)
      {
        start(std::move(x_), std::move(product), error_of_product, given);
      }

      /// P(d - F x - eps D (x - center))
      const Vector &residual() const
      {
        return r;
      }

      /// Weighted norm of the residual.
      double residual_norm() const
      {
        return norm_r;
      }

      /// Whether the residual is at most @p target and is that of F x, as accurately as the target requires.
      bool is_solved(const double target)
      {
        return !(norm_r > target) && is_true(target);
      }

      bool has_steps_left() const
      {
        return counts.cg_steps != options.max_iterations;
      }

      /// Moves x along directions of the store.
      void move_along_stored(const std::vector<double> &coefficients)
      {
        add_stored(1., coefficients, &Direction::p, x);
        add_stored(1., coefficients, &Direction::Fp, Fx);
        error = std::hypot(error, error_of(coefficients));
        update_residual();
      }

      /// Moves x by t p, a new direction. @return whether the residual decreases.
      bool move(const double t, Vector p, Vector Fp, const double error_of_Fp)
      {
        const double before = norm_r;
        add(t, p, x);
        add(t, Fp, Fx);
        error = std::hypot(error, t * error_of_Fp);
        update_residual();
        ++counts.cg_steps;
        made.push_back({std::move(p), std::move(Fp), error_of_Fp});
        n_stuck = norm_r > options.progress * before ? n_stuck + 1 : 0;
        return std::isfinite(norm_r) && n_stuck < options.patience;
      }

      /// The result. New directions are stored here; until then combinations refer to the numbering of the store.
      FaceSolution<Vector> ended(const Status status)
      {
        for (auto &[p, Fp, error_of_Fp] : made)
          store.push(std::move(p), std::move(Fp), error_of_Fp, D, reduction);
        return {status, std::move(x), std::move(Fx), norm_r, error, counts};
      }

      /// Fv = F v
      void multiply(const Vector &v, Vector &Fv)
      {
        face.multiply(v, Fv);
        ++counts.hessian_multiplications;
      }

      /// y += (C + eps D) v
      void add_compliances(const Vector &v, Vector &y) const
      {
        add_compliance(turns, v, y);
        if (regularization > 0)
          add_diagonal(regularization, *D, v, y);
      }

      /// M times the residual, moved to the kernel of G.
      Vector preconditioned(const Vector &residual)
      {
        Vector p(residual);
        face.precondition(residual, p);
        ++counts.preconditioner_applications;
        face.project_kernel(p);
        return p;
      }

      /// q := P q
      void project(Vector &q)
      {
        face.project_range(static_cast<const Vector &>(q), w);
        add(-1.0, w, q);
      }

      /// In the norm of the residual: entries are turned, and those across a slipping force count relative to their own
      /// compliance, since the force follows the slip.
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

      /// The inverse of weighted().
      void unweight(Vector &v) const
      {
        for (const Turn &of : turns)
          v.begin()[of.second] /= of.softness(weight(of.second));
        for (std::size_t i = 0; i < local_size(v); ++i)
          v.begin()[i] /= weight(i);
        turn_back(turns, v);
      }

      /// This process' part of the argument of rounding_of_product().
      double squares(const Vector &p, const Vector &Fp) const
      {
        return local_squares(weights, p, Fp);
      }

      /// v += factor times a combination of the directions of the store, or of their products.
      void add_stored(const double               factor,
                      const std::vector<double> &coefficients,
                      Vector Direction::*const part,
                      Vector                  &v) const
      {
        recycled.add_combination(
          factor,
          coefficients,
          [this, part](const std::size_t j) -> const Vector & { return store[j].*part; },
          v);
      }

      /// Rounding error of the product of a combination of directions of the store.
      double error_of(const std::vector<double> &coefficients) const
      {
        double square = 0;
        for (std::size_t j = 0; j < n_recycled; ++j)
          square += coefficients[j] * coefficients[j] * store[j].error * store[j].error;
        return std::sqrt(square);
      }

      const Face              &face;
      DirectionStore<Vector>  &store;
      const FaceSolverOptions &options;
      const std::vector<Turn>  turns;
      const Reduction         &reduction;
      const double             regularization; // eps
      const bool               is_turned;      // on any process
      const bool               has_compliance;
      const Recycled<Vector>   recycled;
      const std::size_t        n_recycled; // directions in the store
      std::vector<std::vector<double>>
        violations; // of the conditions of a turned face, for the directions of the store

    private:
      struct Made
      {
        Vector p, Fp;
        double error; // of Fp
      };

      // Whether the residual is that of F x, as accurately as the target requires. If not, F x is computed anew
      // (residual replacement: van der Vorst, Ye 2000), provided that this is more accurate.
      bool is_true(const double target)
      {
        const double trusted = options.accuracy * target;
        if (error <= trusted || is_replaced)
          return true;
        const double least = rounding_of_product(reduction.sum(std::array<double, 1>{{squares(x, Fx)}})[0]);
        if (!(least <= std::max(trusted, 0.1 * error)))
          return true;
        is_replaced = true;
        multiply(x, Fx);
        error = least;
        update_residual();
        return norm_r <= target;
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
        project(r);
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

      double weight(const std::size_t i) const
      {
        return weights ? weights[i] : 1.;
      }

      const Vector                    &given;
      const double                    *weights;
      const std::vector<double> *const D; // null: none

      Vector            d, x, Fx, r, w;
      double            norm_r      = 0;
      double            error       = 0; // of Fx
      bool              is_replaced = false;
      unsigned int      n_stuck     = 0;
      std::vector<Made> made;
      Counts            counts;
    };
  } // namespace detail
} // namespace slipstick::qp
