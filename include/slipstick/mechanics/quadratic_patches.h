// Recovery of stresses on a subdomain of elements of degree 2.
#pragma once

#include <slipstick/mechanics/patch_sums.h>

namespace slipstick::mechanics
{
  /// Superconvergent patch recovery (Zienkiewicz, Zhu 1992): around every vertex a polynomial of degree 2 is fitted to
  /// the stresses at the points of Element::stress of the adjacent cells. Where the points do not determine it, e.g.
  /// across a boundary, slopes are fitted first, then the smallest coefficients of degree 2. On quadrilaterals and
  /// hexahedra the constant is then fitted to the point of each cell that is nearest to the vertex, so that peaks are
  /// not smoothed; on triangles and tetrahedra single points are not superconvergent. Other nodes take the mean of the
  /// polynomials of the vertices of their edge, face or cell.
  template <int dim>
  class QuadraticPatches
  {
  public:
    /// @p shared as for PatchSums.
    QuadraticPatches(const dealii::DoFHandler<dim>   &dof_handler,
                     const Element<dim>              &element,
                     StressSamples<dim>               samples,
                     const std::vector<unsigned int> &shared);

    /// First step: finds coordinates around every vertex in which the covariance of the points is 1, so that slender
    /// and oblique cells are treated like others; complete after sums.finish().
    void start_metrics();

    /// Second step: fits the polynomials.
    void start_fit();

    /// Recovered stresses, nodes x components.
    Eigen::MatrixXd nodal() const;

    PatchSums<dim> sums;

    static constexpr unsigned int n_monomials = (dim + 1) * (dim + 2) / 2;

  private:
    using Vector    = Eigen::Matrix<double, dim, 1>;
    using Monomials = Eigen::Matrix<double, n_monomials, 1>;

    Monomials monomials(const unsigned int vertex, const Vector &from_vertex) const;

    const dealii::DoFHandler<dim> &dof_handler;
    const Element<dim>            &element;
    StressSamples<dim>             samples;
    const unsigned int             n_components;
    std::vector<std::vector<unsigned int>>
      nearest; // points that determine the constant, by vertex of the reference cell

    // by vertex
    std::vector<Eigen::Matrix<double, dim, dim>>                         metrics;
    std::vector<Eigen::Matrix<double, int(n_monomials), Eigen::Dynamic>> polynomials; // monomials x components
  };
} // namespace slipstick::mechanics
