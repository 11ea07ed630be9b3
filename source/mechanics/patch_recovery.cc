#include <slipstick/mechanics/patch_recovery.h>

#include <deal.II/dofs/dof_accessor.h>

#include <optional>

namespace slipstick::mechanics
{
  namespace
  {
    // Normal equations, scaled to a unit diagonal, determine the coefficients if no pivot is below this: a nearly
    // undetermined polynomial has large errors at a vertex in the corner of its points.
    constexpr double least_pivot = 1e-3;

    /// Monomials of degree 2 in the distance from a vertex: 1, x, y, xx, xy, yy.
    template <int dim>
    Eigen::Matrix<double, PatchRecovery<dim>::n_monomials, 1> monomials(const dealii::Tensor<1, dim> &x)
    {
      Eigen::Matrix<double, PatchRecovery<dim>::n_monomials, 1> result;
      unsigned int                                              next = 0;
      result[next++]                                                 = 1;
      for (unsigned int d = 0; d < dim; ++d)
        result[next++] = x[d];
      for (unsigned int d = 0; d < dim; ++d)
        for (unsigned int e = d; e < dim; ++e)
          result[next++] = x[d] * x[e];
      return result;
    }

    template <int dim>
    using Polynomial = Eigen::Matrix<double,
                                     PatchRecovery<dim>::n_monomials,
                                     Eigen::Dynamic,
                                     0,
                                     PatchRecovery<dim>::n_monomials,
                                     PatchRecovery<dim>::max_components>;

    /// The first n_functions coefficients; nothing if the normal equations do not determine them.
    template <int n_functions, class Matrix, class Right>
    std::optional<Eigen::Matrix<double, n_functions, Eigen::Dynamic>> solved(const Matrix &matrix, const Right &right)
    {
      const Eigen::Matrix<double, n_functions, n_functions> part =
        matrix.template topLeftCorner<n_functions, n_functions>();
      const Eigen::Matrix<double, n_functions, 1> scale = part.diagonal().cwiseSqrt().cwiseInverse();
      const Eigen::LDLT<Eigen::Matrix<double, n_functions, n_functions>> factor(scale.asDiagonal() * part *
                                                                                scale.asDiagonal());
      if (!(factor.vectorD().minCoeff() > least_pivot))
        return {};
      return scale.asDiagonal() * factor.solve(scale.asDiagonal() * right.template topRows<n_functions>());
    }

    /// Coefficients from the sums of one vertex: of degree 2, otherwise of degree 1; nothing if neither is determined.
    template <int dim>
    std::optional<Polynomial<dim>> fitted(const Eigen::RowVectorXd &sums, const unsigned int n_components)
    {
      constexpr unsigned int      n = PatchRecovery<dim>::n_monomials;
      Eigen::Matrix<double, n, n> matrix;
      Polynomial<dim>             right(n, n_components);
      unsigned int                next = 0;
      for (unsigned int i = 0; i < n; ++i)
        for (unsigned int j = i; j < n; ++j)
          matrix(i, j) = matrix(j, i) = sums[next++];
      for (unsigned int i = 0; i < n; ++i)
        for (unsigned int c = 0; c < right.cols(); ++c)
          right(i, c) = sums[next++];
      if (!(matrix.diagonal().minCoeff() > 0))
        return {};
      if (const auto quadratic = solved<n>(matrix, right))
        return Polynomial<dim>(*quadratic);
      constexpr unsigned int n_linear = dim + 1;
      const auto             linear   = solved<n_linear>(matrix, right);
      if (!linear)
        return {};
      Polynomial<dim> result   = Polynomial<dim>::Zero(n, n_components);
      result.topRows(n_linear) = *linear;
      return result;
    }
  } // namespace

  template <int dim>
  PatchRecovery<dim>::PatchRecovery(const dealii::DoFHandler<dim> &dof_handler_, const unsigned int n_components_)
    : sums(Eigen::MatrixXd::Zero(dof_handler_.n_dofs() / dim, n_sums(n_components_)))
    , dof_handler(dof_handler_)
    , n_components(n_components_)
  {}

  template <int dim>
  void PatchRecovery<dim>::add(const typename dealii::DoFHandler<dim>::active_cell_iterator &cell,
                               const std::vector<dealii::Point<dim>>                        &points,
                               const Eigen::MatrixXd                                        &values)
  {
    for (const unsigned int v : cell->vertex_indices())
      {
        auto at_vertex = sums.row(cell->vertex_dof_index(v, 0) / dim);
        for (unsigned int q = 0; q < points.size(); ++q)
          {
            const auto   p    = monomials<dim>(points[q] - cell->vertex(v));
            unsigned int next = 0;
            for (unsigned int i = 0; i < n_monomials; ++i)
              for (unsigned int j = i; j < n_monomials; ++j)
                at_vertex[next++] += p[i] * p[j];
            for (unsigned int i = 0; i < n_monomials; ++i)
              for (unsigned int c = 0; c < n_components; ++c)
                at_vertex[next++] += p[i] * values(q, c);
          }
      }
  }

  template <int dim>
  void PatchRecovery<dim>::recover(Eigen::MatrixXd &nodal) const
  {
    std::vector<std::optional<std::optional<Polynomial<dim>>>> polynomials(sums.rows());
    const auto                                                 polynomial = [&](const unsigned int node) {
      if (!polynomials[node])
        polynomials[node] = fitted<dim>(sums.row(node), n_components);
      return *polynomials[node];
    };
    for (const auto &cell : dof_handler.active_cell_iterators())
      for (const unsigned int l : cell->line_indices())
        {
          const auto               line   = cell->line(l);
          const unsigned int       middle = line->dof_index(0) / dim;
          const dealii::Point<dim> x      = line->center(true);
          Eigen::RowVectorXd       sum    = Eigen::RowVectorXd::Zero(n_components);
          unsigned int             n      = 0;
          for (unsigned int end = 0; end < 2; ++end)
            {
              const unsigned int node = line->vertex_dof_index(end, 0) / dim;
              if (const auto fit = polynomial(node))
                {
                  nodal.row(node).head(n_components) = fit->row(0);
                  sum += monomials<dim>(x - line->vertex(end)).transpose() * *fit;
                  ++n;
                }
            }
          if (n > 0)
            nodal.row(middle).head(n_components) = sum / n;
        }
  }

  template class PatchRecovery<2>;
  template class PatchRecovery<3>;
} // namespace slipstick::mechanics
