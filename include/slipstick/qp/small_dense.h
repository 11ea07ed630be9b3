// Small dense symmetric systems (size of a Krylov space), the same on every process.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numeric>
#include <vector>

namespace slipstick::qp
{
  /// A = A', n x n.
  class SmallSymmetric
  {
  public:
    explicit SmallSymmetric(const std::size_t n_ = 0)
      : n(n_)
      , values(n_ * n_, 0.)
    {}

    std::size_t size() const
    {
      return n;
    }
    double &operator()(const std::size_t i, const std::size_t j)
    {
      return values[i * n + j];
    }
    double operator()(const std::size_t i, const std::size_t j) const
    {
      return values[i * n + j];
    }

  private:
    std::size_t         n;
    std::vector<double> values;
  };

  /// Scaled Cholesky factors with diagonal pivoting of a positive semidefinite matrix. Rows that depend on previous
  /// pivots are skipped, so that solve() gives a basic solution of consistent systems. Higham 2002, section 10.3.
  class PivotedCholesky
  {
  public:
    /// @param sizes values of the diagonal without cancellation; rows and columns are divided by their square roots, so
    /// that a diagonal entry that is only rounding is not used as a pivot.
    /// @param dependence pivots of the scaled matrix below this count as zero.
    PivotedCholesky(SmallSymmetric A, const std::vector<double> &sizes, const double dependence)
      : L(std::move(A))
      , scale(L.size())
      , order(L.size())
    {
      const std::size_t n = L.size();
      std::iota(order.begin(), order.end(), std::size_t(0));
      for (std::size_t i = 0; i < n; ++i)
        scale[i] = sizes[i] > 0 ? 1 / std::sqrt(sizes[i]) : 0.;
      for (std::size_t i = 0; i < n; ++i)
        for (std::size_t j = 0; j < n; ++j)
          L(i, j) *= scale[i] * scale[j];
      for (; rank < n && bring_largest_pivot(dependence); ++rank)
        eliminate();
    }

    /// x = A^-1 b.
    std::vector<double> solve(const std::vector<double> &b) const
    {
      std::vector<double> y(rank), x(L.size(), 0.);
      for (std::size_t i = 0; i < rank; ++i)
        {
          y[i] = scale[order[i]] * b[order[i]];
          for (std::size_t j = 0; j < i; ++j)
            y[i] -= L(i, j) * y[j];
          y[i] /= L(i, i);
        }
      for (std::size_t i = rank; i-- > 0;)
        {
          for (std::size_t j = i + 1; j < rank; ++j)
            y[i] -= L(j, i) * y[j];
          y[i] /= L(i, i);
          x[order[i]] = scale[order[i]] * y[i];
        }
      return x;
    }

  private:
    bool bring_largest_pivot(const double dependence)
    {
      const std::size_t n     = L.size();
      std::size_t       pivot = rank;
      for (std::size_t i = rank + 1; i < n; ++i)
        if (L(i, i) > L(pivot, pivot))
          pivot = i;
      if (!(L(pivot, pivot) > dependence))
        return false;
      std::swap(order[rank], order[pivot]);
      for (std::size_t j = 0; j < n; ++j)
        std::swap(L(rank, j), L(pivot, j));
      for (std::size_t i = 0; i < n; ++i)
        std::swap(L(i, rank), L(i, pivot));
      return true;
    }

    // Computes one column of L; the trailing block becomes its Schur complement.
    void eliminate()
    {
      const std::size_t n = L.size(), k = rank;
      L(k, k) = std::sqrt(L(k, k));
      for (std::size_t i = k + 1; i < n; ++i)
        L(i, k) /= L(k, k);
      for (std::size_t i = k + 1; i < n; ++i)
        for (std::size_t j = k + 1; j < n; ++j)
          L(i, j) -= L(i, k) * L(j, k);
    }

    SmallSymmetric           L; // in its leading rows; followed by the block of skipped rows
    std::vector<double>      scale;
    std::vector<std::size_t> order;
    std::size_t              rank = 0;
  };
} // namespace slipstick::qp
