#include <slipstick/tfeti/semidefinite_factor.h>

#include <Eigen/OrderingMethods>

namespace slipstick::tfeti
{
  namespace
  {
    // Pivots below this part of the diagonal entry are rounding.
    constexpr double least_kept_pivot = 1e-11;
  } // namespace

  SemidefiniteFactor::SemidefiniteFactor(const Eigen::SparseMatrix<double> &matrix)
  {
    const int                                                     n = matrix.cols();
    Eigen::PermutationMatrix<Eigen::Dynamic, Eigen::Dynamic, int> to_new(n);
    Eigen::AMDOrdering<int>()(matrix, to_new); // indices()[k]: the row that comes as the k-th
    order.assign(to_new.indices().data(), to_new.indices().data() + n);
    std::vector<int> position(n);
    for (int k = 0; k < n; ++k)
      position[order[k]] = k;

    // elimination tree and counts of the columns of L
    std::vector<int> parent(n, -1), mark(n, -1), count(n, 0);
    const auto       for_each_above = [&](const int k, const auto &f) { // entries (i, k) of the permuted matrix, i < k
      for (Eigen::SparseMatrix<double>::InnerIterator entry(matrix, order[k]); entry; ++entry)
        if (const int i = position[entry.row()]; i <= k)
          f(i, entry.value());
    };
    for (int k = 0; k < n; ++k)
      {
        mark[k] = k;
        for_each_above(k, [&](int i, double) {
          for (; mark[i] != k; i = parent[i])
            {
              if (parent[i] < 0)
                parent[i] = k;
              ++count[i];
              mark[i] = k;
            }
        });
      }
    first.assign(n + 1, 0);
    for (int k = 0; k < n; ++k)
      first[k + 1] = first[k] + count[k];
    row.resize(first[n]);
    value.resize(first[n]);
    inverse_pivot.resize(n);

    // row k of L from a triangular solve with the columns before it
    std::vector<double> y(n, 0.);
    std::vector<int>    pattern(n), path(n), filled(n, 0);
    for (int k = 0; k < n; ++k)
      {
        int top = n;
        mark[k] = n + k;
        for_each_above(k, [&](int i, const double a) {
          y[i] += a;
          int length = 0;
          for (; mark[i] != n + k; i = parent[i])
            {
              path[length++] = i;
              mark[i]        = n + k;
            }
          while (length > 0)
            pattern[--top] = path[--length];
        });
        const double diagonal = y[k];
        double       pivot    = diagonal;
        y[k]                  = 0;
        for (; top < n; ++top)
          {
            const int    i  = pattern[top];
            const double yi = y[i];
            y[i]            = 0;
            for (int p = first[i]; p < first[i] + filled[i]; ++p)
              y[row[p]] -= value[p] * yi;
            const double l = yi * inverse_pivot[i];
            pivot -= l * yi;
            row[first[i] + filled[i]]   = k;
            value[first[i] + filled[i]] = l;
            ++filled[i];
          }
        const bool is_kept = pivot > least_kept_pivot * diagonal;
        inverse_pivot[k]   = is_kept ? 1 / pivot : 0.;
        if (!is_kept)
          skipped.push_back(order[k]);
      }
  }

  Eigen::VectorXd SemidefiniteFactor::solve(const Eigen::VectorXd &b) const
  {
    const int           n = order.size();
    std::vector<double> x(n);
    for (int k = 0; k < n; ++k)
      x[k] = b[order[k]];
    for (int k = 0; k < n; ++k)
      for (int p = first[k]; p < first[k + 1]; ++p)
        x[row[p]] -= value[p] * x[k];
    Eigen::VectorXd result(n);
    for (int k = n - 1; k >= 0; --k)
      {
        x[k] *= inverse_pivot[k];
        for (int p = first[k]; p < first[k + 1]; ++p)
          x[k] -= value[p] * x[row[p]];
        // skipped rows stay 0
        if (inverse_pivot[k] == 0)
          x[k] = 0;
        result[order[k]] = x[k];
      }
    return result;
  }
} // namespace slipstick::tfeti
