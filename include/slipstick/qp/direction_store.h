// Directions of all solves so far with their products. Every face uses the combinations that it admits: total reuse of
// Krylov spaces (Gosselet, Rey, Pebay 2013), with the bounds of contact as conditions on the combinations.
//
// A product F p is valid for every face; only the admissible p depend on the face. A face that differs from earlier
// ones by a few entries at bounds loses only a few combinations and keeps the rest of what is known about F.
#pragma once

#include <slipstick/qp/kernels.h>
#include <slipstick/qp/small_dense.h>

#include <cmath>
#include <deque>
#include <utility>
#include <vector>

namespace slipstick::qp
{
  /// Estimated rounding error of a product F p in the norm of residuals. @p squares is |p|^2 plus the square of that
  /// norm of F p: |F| is near 1, and a product is accurate to a few unit roundoffs (1.1e-16).
  inline double rounding_of_product(const double squares)
  {
    constexpr double roundoffs = 1e-15;
    return roundoffs * std::sqrt(squares);
  }

  /// The argument of rounding_of_product(), for the owned entries. @param weights of the norm of residuals.
  template <typename Vector>
  double local_squares(const double *weights, const Vector &p, const Vector &Fp)
  {
    return local_dot(p, p) + local_weighted_dot(weights, Fp, Fp);
  }

  /// The latest directions p, G p = 0, with F p; also p'F p of all pairs, and p'D p if there is a D.
  template <typename Vector>
  class DirectionStore
  {
  public:
    struct Direction
    {
      Vector              p, Fp;
      std::vector<double> pFp, pDp; // with all directions present when this one was added, itself last
      double              error;    // of Fp by rounding, estimated in the norm of residuals
    };

    /// @param capacity if it is exceeded, the oldest directions are dropped.
    explicit DirectionStore(const std::size_t capacity_)
      : capacity(capacity_)
    {}

    std::size_t size() const
    {
      return directions.size();
    }
    const Direction &operator[](const std::size_t j) const
    {
      return directions[j];
    }
    /// p_i'(F + factor D) p_j
    double energy(const std::size_t i, const std::size_t j, const double factor = 0) const
    {
      const Direction  &later = directions[std::max(i, j)];
      const std::size_t place = later.pFp.size() - 1 - (std::max(i, j) - std::min(i, j));
      return later.pFp[place] + (factor > 0 ? factor * later.pDp[place] : 0.);
    }

    /// @param D dependent_compliances() of the problem.
    template <typename Reduction>
    void push(Vector p, Vector Fp, const double error, const std::vector<double> *D, const Reduction &reduction)
    {
      if (directions.size() == capacity)
        directions.pop_front();
      std::vector<double> pFp, pDp;
      for (const Direction &other : directions)
        pFp.push_back(local_dot(other.p, Fp));
      pFp.push_back(local_dot(p, Fp));
      sum_all(pFp, reduction);
      if (D)
        {
          for (const Direction &other : directions)
            pDp.push_back(local_diagonal_dot(*D, other.p, p));
          pDp.push_back(local_diagonal_dot(*D, p, p));
          sum_all(pDp, reduction);
        }
      directions.push_back({std::move(p), std::move(Fp), std::move(pFp), std::move(pDp), error});
    }

  private:
    const std::size_t     capacity;
    std::deque<Direction> directions;
  };

  /// Combinations of directions that satisfy the linear conditions of a face: one vector of coefficients for each.
  using Combinations = std::vector<std::vector<double>>;

  /// The combinations for which conditions(p), the values on this process that must vanish, are zero up to rounding.
  /// The latest directions are processed first, since they were made for a similar face.
  template <typename Vector, typename Conditions, typename Reduction>
  Combinations admissible_combinations(const DirectionStore<Vector> &store,
                                       const Conditions             &conditions,
                                       const Reduction              &reduction)
  {
    // A remainder below this part of the summed directions is zero up to rounding ...
    constexpr double rounding = 1e-13;
    // ... and one below this part of the original violation is too small for a pivot.
    constexpr double least_pivot = 1e-4;

    const std::size_t                n = store.size();
    std::vector<std::vector<double>> violation(n);
    std::vector<double>              squares(2 * n);
    for (std::size_t j = 0; j < n; ++j)
      {
        violation[j]   = conditions(store[j].p);
        squares[j]     = local_dot(violation[j], violation[j]);
        squares[n + j] = local_dot(store[j].p, store[j].p);
      }
    sum_all(squares, reduction);
    struct Pivot
    {
      std::vector<double> direction, coefficients; // normalised violation, and its combination
    };
    std::vector<Pivot> pivots;
    Combinations       result;
    for (std::size_t j = n; j-- > 0;)
      {
        std::vector<double> coefficients(n, 0.);
        coefficients[j] = 1;
        if (squares[j] > rounding * rounding * squares[n + j])
          {
            std::vector<double> v = violation[j];
            for (unsigned int pass = 0; pass < 2; ++pass) // twice is enough
              {
                std::vector<double> along;
                for (const Pivot &pivot : pivots)
                  along.push_back(local_dot(pivot.direction, v));
                sum_all(along, reduction);
                for (std::size_t i = 0; i < pivots.size(); ++i)
                  {
                    add(-along[i], pivots[i].direction, v);
                    add(-along[i], pivots[i].coefficients, coefficients);
                  }
              }
            const double left = norm(v, reduction), before = std::sqrt(squares[j]);
            if (left > least_pivot * before)
              {
                combine(1 / left, v, 0., v);
                combine(1 / left, coefficients, 0., coefficients);
                pivots.push_back({std::move(v), std::move(coefficients)});
                continue;
              }
            double summed = 0;
            for (std::size_t k = 0; k < n; ++k)
              summed += coefficients[k] * coefficients[k] * squares[n + k];
            if (left > rounding * std::sqrt(summed))
              continue;
          }
        result.push_back(std::move(coefficients));
      }
    return result;
  }
} // namespace slipstick::qp
