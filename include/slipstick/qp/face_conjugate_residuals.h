// Generalised conjugate residuals, for all faces (face_solver.h).
#pragma once

#include <slipstick/qp/face_iterate.h>

#include <array>
#include <cmath>
#include <optional>
#include <utility>
#include <vector>

namespace slipstick::qp::detail
{
  // If the rounding error of the product of a direction, made orthogonal to others, is above this part of its image, F
  // is multiplied again: directions are combined from earlier ones, and their errors grow exponentially otherwise.
  constexpr double trusted_error = 1e-4;

  /// The residual is minimised on the combinations of stored directions and on new directions, whose images
  /// q = weighted P (F + C + eps D) p are orthonormal. Those stored directions of a turned face that violate its
  /// conditions slightly serve as part of the preconditioner.
  template <typename Vector, typename Face>
  class FaceConjugateResiduals
  {
  public:
    explicit FaceConjugateResiduals(FaceIterate<Vector, Face> &at_)
      : at(at_)
    {}

    /// Goes to the least residual on the stored directions, unless the weighted residual is at most @p target.
    void use_store(const double target)
    {
      if (at.n_recycled == 0 || !(at.residual_norm() > target))
        return;
      for (std::size_t j = 0; j < at.n_recycled; ++j)
        images.push_back(image(at.store[j].p, at.store[j].Fp));
      const SmallSymmetric all = gram(images);
      if (at.recycled.size() > 0)
        known.emplace(at.recycled.factor([&all](const std::size_t i, const std::size_t j) { return all(i, j); }));
      for (unsigned int pass = 0; known && pass < 2 && at.residual_norm() > target; ++pass)
        at.move_along_stored(coefficients(at.weighted(at.residual())));
      if (!at.violations.empty())
        nearly.emplace(regularized(all, gram(at.violations)));
    }

    /// @return the reason, if there is no step or it does not reduce the residual
    std::optional<Status> step()
    {
      Vector p    = nearly ? preconditioned() : at.preconditioned(at.residual());
      Own    made = with_image(std::move(p));
      double size = norm(made.q, at.reduction);
      orthogonalise(made);
      double length = norm(made.q, at.reduction);
      if (clean(made) || made.error > trusted_error * length)
        {
          made = with_image(std::move(made.p));
          size = norm(made.q, at.reduction);
          orthogonalise(made);
          length = norm(made.q, at.reduction);
        }
      if (!(length > at.options.rounding * size) || made.error > trusted_error * length)
        return Status::stagnated;
      for (Vector *v : {&made.p, &made.Fp, &made.q})
        combine(1. / length, *v, 0., *v);
      made.error /= length;
      const double along = dot(at.weighted(at.residual()), made.q, at.reduction);
      if (length < at.options.exhausted * size && !(std::abs(along) > at.options.least_part * at.residual_norm()))
        return Status::stagnated;
      own.push_back(std::move(made));
      if (!at.move(along, own.back().p, own.back().Fp, own.back().error))
        return Status::stagnated;
      return {};
    }

  private:
    using Direction = typename DirectionStore<Vector>::Direction;

    struct Own
    {
      Vector p, Fp, q;
      double error; // of Fp
    };

    Own with_image(Vector p)
    {
      Vector Fp(p);
      at.multiply(p, Fp);
      Vector       q      = image(p, Fp);
      const double square = at.reduction.sum(std::array<double, 1>{{at.squares(p, Fp)}})[0];
      return {std::move(p), std::move(Fp), std::move(q), rounding_of_product(square)};
    }

    // Directions that cancel leave more than rounding of the conditions of the face and of G p = 0: p is moved back.
    // @return whether the product is that of another p, more than its error tells
    bool clean(Own &made) const
    {
      Vector cleaned(made.p);
      at.face.clear_held(cleaned);
      at.face.project_kernel(cleaned);
      const double size = norm(cleaned, at.reduction);
      add(-1., cleaned, made.p);
      const double change = norm(made.p, at.reduction);
      made.p              = std::move(cleaned);
      made.error          = std::hypot(made.error, change);
      return change > at.options.trusted_change * size;
    }

    // Makes q orthogonal to the images of the directions of the store and of the own ones.
    void orthogonalise(Own &made) const
    {
      for (unsigned int pass = 0; pass < 2; ++pass) // twice is enough
        {
          if (known)
            {
              const auto c = coefficients(made.q);
              made.error   = std::hypot(made.error, at.error_of(c));
              at.add_stored(-1., c, &Direction::p, made.p);
              at.add_stored(-1., c, &Direction::Fp, made.Fp);
              at.recycled.add_combination(
                -1.,
                c,
                [this](const std::size_t j) -> const Vector & { return images[j]; },
                made.q);
            }
          std::vector<double> along;
          for (const Own &other : own)
            along.push_back(local_dot(made.q, other.q));
          sum_all(along, at.reduction);
          for (std::size_t j = 0; j < own.size(); ++j)
            {
              add(-along[j], own[j].p, made.p);
              add(-along[j], own[j].Fp, made.Fp);
              add(-along[j], own[j].q, made.q);
              made.error = std::hypot(made.error, along[j] * own[j].error);
            }
        }
    }

    // Of the directions of the store, for the point nearest to v on the images of their combinations.
    std::vector<double> coefficients(const Vector &v) const
    {
      return at.recycled.coefficients(known->solve(at.recycled.combined(dots_with_images(v))));
    }

    std::vector<double> dots_with_images(const Vector &v) const
    {
      std::vector<double> result;
      for (const Vector &q : images)
        result.push_back(local_dot(v, q));
      sum_all(result, at.reduction);
      return result;
    }

    // weighted P (F + C + eps D) p
    Vector image(const Vector &p, const Vector &Fp)
    {
      Vector q(Fp);
      at.add_compliances(p, q);
      at.project(q);
      return at.weighted(q);
    }

    // Factors of the least squares problem for all directions of the store, in which violations of the conditions of
    // the face count as residuals.
    PivotedCholesky regularized(SmallSymmetric of_images, const SmallSymmetric &of_violations) const
    {
      std::vector<double> sizes;
      for (std::size_t i = 0; i < at.n_recycled; ++i)
        {
          for (std::size_t j = 0; j < at.n_recycled; ++j)
            of_images(i, j) += at.options.violation_weight * at.options.violation_weight * of_violations(i, j);
          sizes.push_back(of_images(i, i));
        }
      return PivotedCholesky(std::move(of_images), sizes, dependent_direction);
    }

    // The combination of directions of the store that reduces the residual most, moved onto the face (where the stored
    // products are only approximate), plus M times the residual that it leaves.
    Vector preconditioned()
    {
      Vector     left = at.weighted(at.residual()), p = zero_like(left);
      const auto c = nearly->solve(dots_with_images(left));
      for (std::size_t j = 0; j < at.n_recycled; ++j)
        {
          add(-c[j], images[j], left);
          add(c[j], at.store[j].p, p);
        }
      at.unweight(left);
      at.face.clear_held(p);
      add(1., at.preconditioned(left), p);
      at.face.project_kernel(p);
      return p;
    }

    // v_i'v_j of all pairs of distributed vectors
    template <typename Any>
    SmallSymmetric gram(const std::vector<Any> &vectors) const
    {
      std::vector<double> products;
      for (std::size_t i = 0; i < vectors.size(); ++i)
        for (std::size_t j = 0; j <= i; ++j)
          products.push_back(local_dot(vectors[i], vectors[j]));
      sum_all(products, at.reduction);
      SmallSymmetric result(vectors.size());
      std::size_t    next = 0;
      for (std::size_t i = 0; i < vectors.size(); ++i)
        for (std::size_t j = 0; j <= i; ++j)
          result(i, j) = result(j, i) = products[next++];
      return result;
    }

    FaceIterate<Vector, Face>     &at;
    std::vector<Vector>            images; // of the directions of the store
    std::optional<PivotedCholesky> known;  // of the images of admissible combinations
    std::optional<PivotedCholesky> nearly; // of the images of all directions, with their violations
    std::vector<Own>               own;
  };
} // namespace slipstick::qp::detail
