#include <slipstick/tfeti/compact_cholesky.h>

#include <algorithm>

namespace slipstick::tfeti
{
  namespace
  {
    using Block   = Eigen::Map<const Eigen::MatrixXf, 0, Eigen::OuterStride<>>;
    using Segment = Eigen::Map<const Eigen::VectorXf>;
  } // namespace

  CompactCholesky::CompactCholesky(const cholmod_factor &factor, const unsigned int n_last)
    : n_trailing(static_cast<int>(n_last))
  {
    const auto  n       = static_cast<int>(factor.n);
    const auto *perm    = static_cast<const int *>(factor.Perm);
    const auto *super   = static_cast<const int *>(factor.super);
    const auto *pi      = static_cast<const int *>(factor.pi);
    const auto *px      = static_cast<const int *>(factor.px);
    const auto *row_of  = static_cast<const int *>(factor.s);
    const auto *entries = static_cast<const double *>(factor.x);
    order.assign(perm, perm + n);
    trailing.assign(static_cast<std::size_t>(n_trailing) * (n_trailing + 1) / 2, 0.f);

    std::size_t n_rows = 0, n_values = 0;
    const auto  interior_rows = [&](const int s) {
      return static_cast<int>(std::lower_bound(row_of + pi[s], row_of + pi[s + 1], n_interior()) - (row_of + pi[s]));
    };
    for (int s = 0; s < static_cast<int>(factor.nsuper) && super[s] < n_interior(); ++s)
      {
        const int n_columns = std::min(super[s + 1], n_interior()) - super[s], k = interior_rows(s);
        n_rows += k - n_columns;
        n_values += static_cast<std::size_t>(k) * n_columns;
      }
    rows.reserve(n_rows);
    values.reserve(n_values);

    for (int s = 0; s < static_cast<int>(factor.nsuper); ++s)
      {
        const int  height = pi[s + 1] - pi[s];
        const int *index  = row_of + pi[s];
        if (super[s] < n_interior())
          {
            const int n_columns = std::min(super[s + 1], n_interior()) - super[s], k = interior_rows(s);
            supernodes.push_back({super[s], n_columns, k, rows.size(), values.size()});
            rows.insert(rows.end(), index + n_columns, index + k);
            longest = std::max(longest, k - n_columns);
            for (int column = 0; column < n_columns; ++column)
              {
                const double *const from = entries + px[s] + static_cast<std::ptrdiff_t>(column) * height;
                for (int i = 0; i < k; ++i)
                  values.push_back(i < column ? 0.f : static_cast<float>(from[i]));
              }
          }
        for (int column = std::max(super[s], n_interior()); column < super[s + 1]; ++column)
          {
            const int           local = column - super[s], j = column - n_interior();
            const double *const from = entries + px[s] + static_cast<std::ptrdiff_t>(local) * height;
            float *const        to   = trailing.data() + static_cast<std::size_t>(j) * n_trailing -
                              static_cast<std::size_t>(j) * (j - 1) / 2 - j; // to[i]: entry (i, j)
            for (int i = local; i < height; ++i)
              to[index[i] - n_interior()] = static_cast<float>(from[i]);
          }
      }
  }

  void CompactCholesky::solve_interior(Eigen::VectorXf &x) const
  {
    Eigen::VectorXf below(longest);
    for (const Supernode &s : supernodes)
      {
        const Block triangle(values.data() + s.values, s.n_columns, s.n_columns, Eigen::OuterStride<>(s.n_rows));
        auto        part = x.segment(s.first, s.n_columns);
        triangle.triangularView<Eigen::Lower>().solveInPlace(part);
        const int n_below = s.n_rows - s.n_columns;
        if (n_below == 0)
          continue;
        const Block rest(values.data() + s.values + s.n_columns, n_below, s.n_columns, Eigen::OuterStride<>(s.n_rows));
        below.head(n_below).noalias() = rest * part;
        for (int i = 0; i < n_below; ++i)
          x[rows[s.rows + i]] -= below[i];
      }
    for (auto s = supernodes.rbegin(); s != supernodes.rend(); ++s)
      {
        const Block triangle(values.data() + s->values, s->n_columns, s->n_columns, Eigen::OuterStride<>(s->n_rows));
        auto        part    = x.segment(s->first, s->n_columns);
        const int   n_below = s->n_rows - s->n_columns;
        if (n_below > 0)
          {
            const Block rest(values.data() + s->values + s->n_columns,
                             n_below,
                             s->n_columns,
                             Eigen::OuterStride<>(s->n_rows));
            for (int i = 0; i < n_below; ++i)
              below[i] = x[rows[s->rows + i]];
            part.noalias() -= rest.transpose() * below.head(n_below);
          }
        triangle.triangularView<Eigen::Lower>().transpose().solveInPlace(part);
      }
  }

  void CompactCholesky::solve_trailing(Eigen::VectorXf &x) const
  {
    const float *column = trailing.data();
    for (int j = 0; j < n_trailing; column += n_trailing - j, ++j)
      {
        x[j] /= column[0];
        const int n_below = n_trailing - j - 1;
        x.segment(j + 1, n_below) -= x[j] * Segment(column + 1, n_below);
      }
    for (int j = n_trailing - 1; j >= 0; --j)
      {
        const int n_below = n_trailing - j - 1;
        column -= n_below + 1;
        x[j] = (x[j] - Segment(column + 1, n_below).dot(x.segment(j + 1, n_below))) / column[0];
      }
  }

  // [I 0; 0 S^-1] between the eliminations of the interior
  void CompactCholesky::apply(const Eigen::SparseMatrix<double> &lower,
                              const Eigen::VectorXd             &r,
                              Eigen::VectorXd                   &z) const
  {
    const int    n      = static_cast<int>(order.size());
    const double length = r.cwiseAbs().maxCoeff();
    z                   = Eigen::VectorXd::Zero(n);
    if (length == 0)
      return;
    Eigen::VectorXf interior(n_interior());
    for (int k = 0; k < n_interior(); ++k)
      interior[k] = static_cast<float>(r[order[k]] / length);
    solve_interior(interior);
    for (int k = 0; k < n_interior(); ++k)
      z[order[k]] = interior[k];
    if (n_trailing > 0)
      {
        Eigen::VectorXd coupling = lower.selfadjointView<Eigen::Lower>() * z;
        Eigen::VectorXf at_trailing(n_trailing);
        for (int k = 0; k < n_trailing; ++k)
          {
            const int unknown = order[n_interior() + k];
            at_trailing[k]    = static_cast<float>(r[unknown] / length - coupling[unknown]);
          }
        solve_trailing(at_trailing);
        Eigen::VectorXd of_trailing = Eigen::VectorXd::Zero(n);
        for (int k = 0; k < n_trailing; ++k)
          of_trailing[order[n_interior() + k]] = at_trailing[k];
        coupling.noalias() = lower.selfadjointView<Eigen::Lower>() * of_trailing;
        for (int k = 0; k < n_interior(); ++k)
          interior[k] = static_cast<float>(coupling[order[k]]);
        solve_interior(interior);
        for (int k = 0; k < n_interior(); ++k)
          z[order[k]] -= interior[k];
        z += of_trailing;
      }
    z *= length;
  }

  std::size_t CompactCholesky::bytes() const
  {
    return (order.size() + rows.size()) * sizeof(int) + (values.size() + trailing.size()) * sizeof(float) +
           supernodes.size() * sizeof(Supernode);
  }
} // namespace slipstick::tfeti
