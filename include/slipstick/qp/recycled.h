// The part of a direction store that a face can use: the combinations that it admits (direction_store.h).
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
    // Directions whose energies (residuals) are combinations of others' up to this part of their square are left out.
    constexpr double dependent_direction = 1e-12;

    /// The combinations of the store that a face admits, and what is solved by them.
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

      /// of[j] of the directions summed up for every combination.
      std::vector<double> combined(const std::vector<double> &of) const
      {
        std::vector<double> result;
        for (const auto &c : combinations)
          result.push_back(local_dot(c, of)); // not distributed
        return result;
      }

      /// Coefficients of the directions, of amounts of the combinations.
      std::vector<double> coefficients(const std::vector<double> &amounts) const
      {
        std::vector<double> result(store.size(), 0.);
        for (std::size_t i = 0; i < combinations.size(); ++i)
          if (amounts[i] != 0)
            add(amounts[i], combinations[i], result);
        return result;
      }

      /// Factors of A(c_i, c_j) of all pairs of combinations, of A(j, k) of the directions. Combinations that cancel to
      /// rounding are left out.
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

      /// x += sum of factor times coefficient times what `part` takes of each direction.
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
