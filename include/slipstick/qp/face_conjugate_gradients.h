// Conjugate gradients with full orthogonalisation, for faces without ties (face_solver.h).
#pragma once

#include <slipstick/qp/face_iterate.h>

#include <array>
#include <cmath>
#include <optional>
#include <utility>
#include <vector>

namespace slipstick::qp::detail
{
  /// A = F + C + eps D is symmetric on such a face: the present point is moved to the minimum on the combinations of
  /// stored directions, then new directions are made A-orthogonal to these and to each other.
  template <typename Vector, typename Face>
  class FaceConjugateGradients
  {
  public:
    explicit FaceConjugateGradients(FaceIterate<Vector, Face> &at_)
      : at(at_)
    {}

    /// Goes to the minimum on the stored directions, unless the weighted residual is at most @p target.
    void use_store(const double target)
    {
      if (at.recycled.size() == 0 || !(at.residual_norm() > target))
        return;
      if (at.is_turned)
        known.emplace(at.recycled.factor(energies_with_compliance()));
      else
        known.emplace(at.recycled.factor(
          [this](const std::size_t i, const std::size_t j) { return at.store.energy(i, j, at.regularization); }));
      for (unsigned int pass = 0; pass < 2 && at.residual_norm() > target; ++pass)
        at.move_along_stored(coefficients(dots_with_stored(at.residual(), &Direction::p)));
    }

    /// @return the reason, if there is no step or it does not reduce the residual
    std::optional<Status> step()
    {
      Vector p = at.preconditioned(at.residual());
      orthogonalise(p);
      Vector Fp(p);
      at.multiply(p, Fp);
      Vector Ap(Fp);
      at.add_compliances(p, Ap);
      const auto [pr, pAp, pFp, pp, squares] = at.reduction.sum(std::array<double, 5>{
        {local_dot(p, at.residual()), local_dot(p, Ap), local_dot(p, Fp), local_dot(p, p), at.squares(p, Fp)}});
      if (!std::isfinite(pr) || !std::isfinite(pAp) || !(pr > 0))
        return Status::stagnated;
      if (pAp <= at.options.smallest_curvature * largest * pp)
        return Status::infeasible;
      largest = std::max(largest, pFp / pp); // without C, which may be 1e8 times as large
      own.push_back({p, std::move(Ap), pAp});
      if (!at.move(pr / pAp, std::move(p), std::move(Fp), rounding_of_product(squares)))
        return Status::stagnated;
      return {};
    }

  private:
    using Direction = typename DirectionStore<Vector>::Direction;

    struct Own
    {
      Vector p, Ap;
      double energy; // p'A p
    };

    // Makes p A-orthogonal to the directions of the store and to the own ones.
    void orthogonalise(Vector &p) const
    {
      if (known)
        at.add_stored(-1., coefficients(dots_with_products(p)), &Direction::p, p);
      std::vector<double> along;
      for (const Own &other : own)
        along.push_back(local_dot(p, other.Ap));
      sum_all(along, at.reduction);
      for (std::size_t j = 0; j < own.size(); ++j)
        add(-along[j] / own[j].energy, own[j].p, p);
    }

    // Of the directions of the store, for the point of least energy on their combinations.
    std::vector<double> coefficients(const std::vector<double> &with_stored) const
    {
      return at.recycled.coefficients(known->solve(at.recycled.combined(with_stored)));
    }

    std::vector<double> dots_with_stored(const Vector &v, Vector Direction::*const part) const
    {
      std::vector<double> result;
      for (std::size_t j = 0; j < at.n_recycled; ++j)
        result.push_back(local_dot(v, at.store[j].*part));
      sum_all(result, at.reduction);
      return result;
    }

    // v'A p_j
    std::vector<double> dots_with_products(const Vector &v) const
    {
      if (!at.has_compliance)
        return dots_with_stored(v, &Direction::Fp);
      Vector Cv = zero_like(v);
      at.add_compliances(v, Cv);
      std::vector<double> result;
      for (std::size_t j = 0; j < at.n_recycled; ++j)
        result.push_back(local_dot(v, at.store[j].Fp) + local_dot(Cv, at.store[j].p));
      sum_all(result, at.reduction);
      return result;
    }

    // p_i'A p_j of the directions of the store
    auto energies_with_compliance() const
    {
      std::vector<double> products;
      for (std::size_t i = 0; i < at.n_recycled; ++i)
        {
          Vector Cp = zero_like(at.store[i].p);
          add_compliance(at.turns, at.store[i].p, Cp);
          for (std::size_t j = 0; j <= i; ++j)
            products.push_back(local_dot(Cp, at.store[j].p));
        }
      sum_all(products, at.reduction);
      SmallSymmetric result(at.n_recycled);
      std::size_t    next = 0;
      for (std::size_t i = 0; i < at.n_recycled; ++i)
        for (std::size_t j = 0; j <= i; ++j)
          result(i, j) = result(j, i) = at.store.energy(i, j, at.regularization) + products[next++];
      return [result](const std::size_t i, const std::size_t j) { return result(i, j); };
    }

    FaceIterate<Vector, Face>     &at;
    std::optional<PivotedCholesky> known; // of the energies of admissible combinations
    std::vector<Own>               own;
    double                         largest = 0; // p'F p / p'p
  };
} // namespace slipstick::qp::detail
