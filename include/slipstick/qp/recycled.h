// The part of a direction store that a face problem can use: the admissible combinations (direction_store.h).
#pragma once

#include <slipstick/qp/direction_store.h>
#include <slipstick/qp/kernels.h>
#include <slipstick/qp/small_dense.h>

#include <utility>
#include <vector>

namespace slipstick::qp
{
  namespace detail
  {
    // Directions are skipped if their squared energy (residual), without the part in the span of others, is below this
    // part of its original value.
    constexpr double dependent_direction = 1e-12;

    /// The combinations in the store that are admissible for a face problem, and the solution in their span.
    template <typename Vector>
    class Recycled
    {
    public:
      Recycled(const DirectionStore<Vector> &store_, Combinations combinations_)
        : store(store_)
        , combinations(std::move(combinations_))
      {}

      std::size_t size() const
      {
        return combinations.size();
      }

      /// Values of[j] of the directions, summed for every combination.
      std::vector<double> combined(const std::vector<double> &of) const
      {
        std::vector<double> result;
        for (const auto &c : combinations)
          result.push_back(local_dot(c, of)); // not a distributed vector
        return result;
      }

      /// Coefficients of the directions from amounts of the combinations.
      std::vector<double> coefficients(const std::vector<double> &amounts) const
      {
        std::vector<double> result(store.size(), 0.);
        for (std::size_t i = 0; i < combinations.size(); ++i)
          if (amounts[i] != 0)
            add(amounts[i], combinations[i], result);
        return result;
      }

      /// Factors of the matrix A(c_i, c_j) of all pairs of combinations, from A(j, k) of the directions. Combinations
      /// that cancel to rounding are skipped.
      template <typename Energy>
      PivotedCholesky factor(const Energy &of) const
      {
        const std::size_t   n = store.size(), m = combinations.size();
        SmallSymmetric      result(m);
        std::vector<double> row(n);
        for (std::size_t i = 0; i < m; ++i)
          {
            for (std::size_t k = 0; k < n; ++k)
              {
                row[k] = 0;
                for (std::size_t j = 0; j < n; ++j)
                  if (combinations[i][j] != 0)
                    row[k] += combinations[i][j] * of(j, k);
              }
            for (std::size_t j = 0; j < m; ++j)
              result(i, j) = local_dot(combinations[j], row);
          }
        std::vector<double> sizes(m, 0.);
        for (std::size_t i = 0; i < m; ++i)
          for (std::size_t j = 0; j < n; ++j)
            sizes[i] += combinations[i][j] * combinations[i][j] * of(j, j);
        return PivotedCholesky(std::move(result), sizes, dependent_direction);
      }

      /// x += sum of factor times coefficient times `part` of each direction.
      template <typename Part>
      void add_combination(const double               factor,
                           const std::vector<double> &coefficients,
                           const Part                &part,
                           Vector                    &x) const
      {
        for (std::size_t j = 0; j < store.size(); ++j)
          if (coefficients[j] != 0)
            add(factor * coefficients[j], part(j), x);
      }

      const DirectionStore<Vector> &store;

    private:
      Combinations combinations;
    };
  } // namespace detail
} // namespace slipstick::qp
