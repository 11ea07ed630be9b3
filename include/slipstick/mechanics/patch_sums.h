// Sums over the cells around every vertex of a subdomain, complete also where subdomains meet.
#pragma once

#include <slipstick/mechanics/spaces.h>

#include <Eigen/Dense>

#include <algorithm>
#include <functional>
#include <vector>

namespace slipstick::mechanics
{
  /// Stresses at the points of Element::stress of all active cells of a subdomain, in their order.
  template <int dim>
  struct StressSamples
  {
    std::vector<dealii::Point<dim>> points;
    Eigen::MatrixXd                 stresses; // points x components [MPa]
  };

  /// Sums by vertex. Those of vertices of this subdomain alone are used at once; those of vertices that it shares are
  /// kept and used after the caller has added the rows of all copies. Large sums are thus held for one subdomain at a
  /// time.
  template <int dim>
  class PatchSums
  {
  public:
    using Sums = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>; // a row for every vertex
    using Row  = Eigen::Ref<const Eigen::RowVectorXd>;
    using Use  = std::function<void(const unsigned int vertex, const Row &sums)>;

    /// @param shared nodes of the displacement space that other subdomains also have.
    PatchSums(const dealii::DoFHandler<dim> &dof_handler, const std::vector<unsigned int> &shared);

    /// @p sum adds to the sums of all vertices of the triangulation; @p use takes the rows.
    void start(const unsigned int n_columns, const std::function<void(Sums &)> &sum, const Use &use);

    /// Between start and finish: to be added over all copies of a vertex.
    Sums of_shared;

    /// Row in `of_shared` of a node of the displacement space; -1 if it is not a shared vertex.
    int row_of(const unsigned int node) const
    {
      return row_of_node[node];
    }

    /// Uses the rows of the shared vertices.
    void finish();

  private:
    unsigned int              n_vertices;
    std::vector<int>          row_of_node;
    std::vector<unsigned int> inner, shared; // vertices
    Use                       use_later;
  };

  /// Sums of squares, positions and number of points around a vertex.
  template <int dim>
  struct PointMoments
  {
    static constexpr unsigned int n_squares = dim * (dim + 1) / 2;
    static constexpr unsigned int n_columns = n_squares + dim + 1;

    template <class Row>
    PointMoments(const Row &row)
      : n(row[n_squares + dim])
    {
      for (unsigned int d = 0; d < dim; ++d)
        mean[d] = row[n_squares + d] / n;
      covariance = symmetric(row, 0) / n - mean * mean.transpose();
    }

    /// Adds a point at the distance @p x from the vertex to the first columns of @p row.
    template <class Row>
    static void add(const Eigen::Matrix<double, dim, 1> &x, Row &&row)
    {
      add_square(x, row, 0);
      for (unsigned int d = 0; d < dim; ++d)
        row[n_squares + d] += x[d];
      row[n_squares + dim] += 1;
    }

    /// Adds a a' to a symmetric matrix in the columns from @p first on.
    template <class Row>
    static void add_square(const Eigen::Matrix<double, dim, 1> &a, Row &&row, unsigned int first)
    {
      for (unsigned int d = 0; d < dim; ++d)
        for (unsigned int e = 0; e <= d; ++e)
          row[first++] += a[d] * a[e];
    }

    template <class Row>
    static Eigen::Matrix<double, dim, dim> symmetric(const Row &row, unsigned int first)
    {
      Eigen::Matrix<double, dim, dim> result;
      for (unsigned int d = 0; d < dim; ++d)
        for (unsigned int e = 0; e <= d; ++e)
          result(d, e) = result(e, d) = row[first++];
      return result;
    }

    /// Variance [mm^2] below which the points count as having no extent in a direction, where @p longest is the largest.
    double least_variance(const double longest) const
    {
      constexpr double largest_aspect_ratio = 1e6;
      constexpr double rounding             = 1e-14; // of squares of distances from the vertex, relative
      return std::max(longest / (largest_aspect_ratio * largest_aspect_ratio), rounding * mean.squaredNorm());
    }

    double                          n;
    Eigen::Matrix<double, dim, 1>   mean;
    Eigen::Matrix<double, dim, dim> covariance;
  };

  template <int dim>
  Eigen::Matrix<double, dim, 1> distance(const dealii::Point<dim> &to, const dealii::Point<dim> &from)
  {
    Eigen::Matrix<double, dim, 1> result;
    for (unsigned int d = 0; d < dim; ++d)
      result[d] = to[d] - from[d];
    return result;
  }
} // namespace slipstick::mechanics
