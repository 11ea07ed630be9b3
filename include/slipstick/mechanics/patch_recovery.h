// Recovery of stresses by least squares over the cells around every vertex.
#pragma once

#include <slipstick/mechanics/spaces.h>

#include <Eigen/Dense>

namespace slipstick::mechanics
{
  /// Superconvergent patch recovery (Zienkiewicz, Zhu 1992) on one subdomain: around every vertex the stresses of the
  /// adjacent cells, at given points, are fitted by a polynomial of degree 2, or of degree 1 if there are too few
  /// points. The sums of the normal equations are added over the copies of a vertex, so that patches extend across
  /// subdomains. For elements of degree 2, a node in the middle of an edge gets the mean of the polynomials of its
  /// ends.
  template <int dim>
  class PatchRecovery
  {
  public:
    static constexpr unsigned int n_monomials    = (dim + 1) * (dim + 2) / 2; // 1, x, y, xx, xy, yy
    static constexpr unsigned int max_components = dim * (dim + 1) / 2 + 1;   // xx, yy, xy, hoop

    /// @param n_components of the stress, at most max_components.
    PatchRecovery(const dealii::DoFHandler<dim> &dof_handler, const unsigned int n_components);

    /// Columns of `sums`.
    static constexpr unsigned int n_sums(const unsigned int n_components)
    {
      return n_monomials * (n_monomials + 1) / 2 + n_monomials * n_components;
    }

    /// Adds the stresses @p values (points x components) at the real @p points of a cell.
    void add(const typename dealii::DoFHandler<dim>::active_cell_iterator &cell,
             const std::vector<dealii::Point<dim>>                        &points,
             const Eigen::MatrixXd                                        &values);

    /// Sums of the normal equations, by node of the displacement space; rows of nodes that are not vertices are zero.
    Eigen::MatrixXd sums;

    /// Writes the recovered stresses into the rows of @p nodal (nodes x at least n_components) where the points around
    /// a vertex determine a polynomial; the other rows are unchanged.
    void recover(Eigen::MatrixXd &nodal) const;

  private:
    const dealii::DoFHandler<dim> &dof_handler;
    unsigned int                   n_components;
  };
} // namespace slipstick::mechanics
