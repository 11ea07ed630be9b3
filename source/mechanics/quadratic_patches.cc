#include <slipstick/mechanics/quadratic_patches.h>

#include <deal.II/dofs/dof_accessor.h>
#include <deal.II/fe/fe_values.h>

#include <algorithm>
#include <cmath>
#include <numeric>

namespace slipstick::mechanics
{
  namespace
  {
    // Points determine a coefficient if their spread exceeds this fraction of the mean spread of all coefficients of
    // its degree.
    constexpr double least_spread = 1e-3;

    /// Symmetric matrix that maps points with this covariance to points with covariance 1; directions without extent
    /// are scaled like the longest one.
    template <int dim>
    Eigen::Matrix<double, dim, dim> to_unit_covariance(const PointMoments<dim> &moments)
    {
      const Eigen::SelfAdjointEigenSolver<Eigen::Matrix<double, dim, dim>> axes(moments.covariance);
      const double                                                         longest = axes.eigenvalues()[dim - 1];
      Eigen::Matrix<double, dim, 1>                                        squares = axes.eigenvalues();
      for (double &square : squares)
        square = square > moments.least_variance(longest) ? square : longest;
      return axes.eigenvectors() * squares.cwiseSqrt().cwiseInverse().asDiagonal() * axes.eigenvectors().transpose();
    }

    /// Inverse on the directions in which @p matrix is above @p least.
    Eigen::MatrixXd inverse_above(const Eigen::MatrixXd &matrix, const double least)
    {
      const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> axes(matrix);
      Eigen::VectorXd                                      inverses = axes.eigenvalues();
      for (double &value : inverses)
        value = value > least ? 1 / value : 0;
      return axes.eigenvectors() * inverses.asDiagonal() * axes.eigenvectors().transpose();
    }

    /// Coefficients that minimise the sum of squares. Where the points do not determine all of them, lower degrees come
    /// first: the smallest slopes that fit best, then the smallest coefficients of degree 2.
    template <int dim>
    Eigen::MatrixXd least_squares(const Eigen::MatrixXd &matrix, const Eigen::MatrixXd &right)
    {
      const unsigned int n = matrix.rows(), n_squares = n - dim - 1;
      // about the mean
      const Eigen::MatrixXd spread = matrix - matrix.col(0) * matrix.row(0) / matrix(0, 0);
      const Eigen::MatrixXd rest   = right - matrix.col(0) * right.row(0) / matrix(0, 0);
      const auto            least  = [&](const unsigned int first, const unsigned int size) {
        return least_spread * matrix.diagonal().segment(first, size).mean();
      };
      const Eigen::MatrixXd slopes = inverse_above(spread.block<dim, dim>(1, 1), least(1, dim));
      const Eigen::MatrixXd mixed  = spread.block(1, dim + 1, dim, n_squares);
      const Eigen::MatrixXd curving =
        spread.bottomRightCorner(n_squares, n_squares) - mixed.transpose() * slopes * mixed;
      const Eigen::MatrixXd of_slopes = rest.middleRows<dim>(1);
      Eigen::MatrixXd       result(n, right.cols());
      result.bottomRows(n_squares) = inverse_above(curving, least(dim + 1, n_squares)) *
                                     (rest.bottomRows(n_squares) - mixed.transpose() * slopes * of_slopes);
      result.middleRows<dim>(1) = slopes * (of_slopes - mixed * result.bottomRows(n_squares));
      result.row(0)             = (right.row(0) - matrix.row(0).tail(n - 1) * result.bottomRows(n - 1)) / matrix(0, 0);
      return result;
    }

    /// Points of the stresses to which the constant of a vertex is fitted.
    template <int dim>
    std::vector<unsigned int> points_nearest(const Element<dim> &element, const unsigned int v)
    {
      std::vector<unsigned int> points(element.stress.size());
      std::iota(points.begin(), points.end(), 0);
      if (element.cell.is_simplex())
        return points; // all points, so that the fit is unchanged
      const auto vertex = element.cell.template vertex<dim>(v);
      return {*std::min_element(points.begin(), points.end(), [&](const unsigned int a, const unsigned int b) {
        return element.stress.point(a).distance(vertex) < element.stress.point(b).distance(vertex);
      })};
    }
  } // namespace

  template <int dim>
  QuadraticPatches<dim>::QuadraticPatches(const dealii::DoFHandler<dim>   &dof_handler_,
                                          const Element<dim>              &element_,
                                          StressSamples<dim>               samples_,
                                          const std::vector<unsigned int> &shared)
    : sums(dof_handler_, shared)
    , dof_handler(dof_handler_)
    , element(element_)
    , samples(std::move(samples_))
    , n_components(samples.stresses.cols())
    , metrics(dof_handler.get_triangulation().n_vertices())
    , polynomials(dof_handler.get_triangulation().n_vertices())
  {
    for (const unsigned int v : element.cell.vertex_indices())
      nearest.push_back(points_nearest(element, v));
  }

  template <int dim>
  void QuadraticPatches<dim>::start_metrics()
  {
    sums.start(
      PointMoments<dim>::n_columns,
      [&](typename PatchSums<dim>::Sums &sum) {
        unsigned int first = 0;
        for (const auto &cell : dof_handler.active_cell_iterators())
          {
            for (const unsigned int v : cell->vertex_indices())
              for (unsigned int q = first; q < first + element.stress.size(); ++q)
                PointMoments<dim>::add(distance<dim>(samples.points[q], cell->vertex(v)),
                                       sum.row(cell->vertex_index(v)));
            first += element.stress.size();
          }
      },
      [this](const unsigned int v, const typename PatchSums<dim>::Row &row) {
        metrics[v] = to_unit_covariance(PointMoments<dim>(row));
      });
  }

  template <int dim>
  void QuadraticPatches<dim>::start_fit()
  {
    constexpr unsigned int at_right      = n_monomials * (n_monomials + 1) / 2;
    const unsigned int     at_near       = at_right + n_monomials * n_components;
    const unsigned int     at_near_right = at_near + n_monomials;
    sums.start(
      at_near_right + n_components,
      [&](typename PatchSums<dim>::Sums &sum) {
        unsigned int first = 0;
        for (const auto &cell : dof_handler.active_cell_iterators())
          {
            for (const unsigned int v : cell->vertex_indices())
              {
                const unsigned int vertex = cell->vertex_index(v);
                auto               row    = sum.row(vertex);
                const auto         at     = [&](const unsigned int q) {
                  return monomials(vertex, distance<dim>(samples.points[first + q], cell->vertex(v)));
                };
                for (unsigned int q = 0; q < element.stress.size(); ++q)
                  {
                    const Monomials m    = at(q);
                    unsigned int    next = 0;
                    for (unsigned int i = 0; i < n_monomials; ++i)
                      for (unsigned int j = i; j < n_monomials; ++j)
                        row[next++] += m[i] * m[j];
                    for (unsigned int i = 0; i < n_monomials; ++i)
                      for (unsigned int c = 0; c < n_components; ++c)
                        row[next++] += m[i] * samples.stresses(first + q, c);
                  }
                for (const unsigned int q : nearest[v])
                  {
                    row.segment(at_near, n_monomials) += at(q).transpose();
                    row.segment(at_near_right, n_components) += samples.stresses.row(first + q);
                  }
              }
            first += element.stress.size();
          }
      },
      [=](const unsigned int v, const typename PatchSums<dim>::Row &row) {
        Eigen::MatrixXd matrix(n_monomials, n_monomials), right(n_monomials, n_components);
        unsigned int    next = 0;
        for (unsigned int i = 0; i < n_monomials; ++i)
          for (unsigned int j = i; j < n_monomials; ++j)
            matrix(i, j) = matrix(j, i) = row[next++];
        for (unsigned int i = 0; i < n_monomials; ++i)
          for (unsigned int c = 0; c < n_components; ++c)
            right(i, c) = row[next++];
        polynomials[v] = least_squares<dim>(matrix, right);
        polynomials[v].row(0) +=
          (row.segment(at_near_right, n_components) - row.segment(at_near, n_monomials) * polynomials[v]) /
          row[at_near];
      });
  }

  template <int dim>
  Eigen::MatrixXd QuadraticPatches<dim>::nodal() const
  {
    const auto                                  &unit = element.scalar->get_unit_support_points();
    dealii::FEValues<dim>                        at_nodes(*element.mapping,
                                   *element.scalar,
                                   dealii::Quadrature<dim>(unit),
                                   dealii::update_quadrature_points);
    Eigen::MatrixXd                              result(dof_handler.n_dofs() / dim, n_components);
    std::vector<dealii::types::global_dof_index> dofs;
    std::vector<unsigned int>                    nodes;
    for (const auto &cell : dof_handler.active_cell_iterators())
      {
        element.nodes_of(cell, dofs, nodes);
        at_nodes.reinit(typename dealii::Triangulation<dim>::cell_iterator(cell)); // only for the points
        for (unsigned int i = 0; i < nodes.size(); ++i)
          {
            Eigen::RowVectorXd mean = Eigen::RowVectorXd::Zero(n_components);
            for (const unsigned int v : cell->vertex_indices())
              if (const double weight = element.cell.d_linear_shape_function(unit[i], v); weight > 0)
                {
                  const unsigned int vertex = cell->vertex_index(v);
                  const Vector       x      = distance<dim>(at_nodes.quadrature_point(i), cell->vertex(v));
                  mean += weight * monomials(vertex, x).transpose() * polynomials[vertex];
                }
            result.row(nodes[i]) = mean;
          }
      }
    return result;
  }

  /// 1, x, y, xx, r xy, yy in the coordinates of the vertex; r is the square root of 2, so that rotations preserve the
  /// sum of the squares of the coefficients.
  template <int dim>
  typename QuadraticPatches<dim>::Monomials QuadraticPatches<dim>::monomials(const unsigned int vertex,
                                                                             const Vector      &from_vertex) const
  {
    static const double root_of_two = std::sqrt(2.);
    const Vector        x           = metrics[vertex] * from_vertex;
    Monomials           result;
    unsigned int        next = 0;
    result[next++]           = 1;
    for (unsigned int d = 0; d < dim; ++d)
      result[next++] = x[d];
    for (unsigned int d = 0; d < dim; ++d)
      {
        result[next++] = x[d] * x[d];
        for (unsigned int e = d + 1; e < dim; ++e)
          result[next++] = root_of_two * x[d] * x[e];
      }
    return result;
  }

  template class QuadraticPatches<2>;
  template class QuadraticPatches<3>;
} // namespace slipstick::mechanics
