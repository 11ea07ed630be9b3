// The dilatation used by the elements: that of the displacement, or a projection of it.
#pragma once

#include <slipstick/mechanics/cell_values.h>
#include <slipstick/mechanics/spaces.h>
#include <slipstick/mesh/kinematics.h>

#include <Eigen/Dense>

namespace slipstick::mechanics
{
  /// Least-squares projection, cell by cell, on polynomials of x and y of one degree less than the displacement: the
  /// mean dilatation (Hughes 1980; degree 1) on quadrilaterals; linear functions, discontinuous, on quadrilaterals of
  /// degree 2 (the pair Q2-P1 satisfies the inf-sup condition, Boffi, Gastaldi 2002); the mean on triangles of degree 2
  /// (P2-P0). The same on hexahedra and tetrahedra.
  template <int dim>
  class DilatationProjection
  {
  public:
    explicit DilatationProjection(const Element<dim> &element)
      : n_functions(element.degree == 2 && !element.cell.is_simplex() ? dim + 1 : 1)
    {}

    /// @p values with quadrature points and JxW; in bodies of revolution the squares are also weighted with the
    /// circumference.
    void reinit(const CellValues<dim> &values, const mesh::Kinematics<dim> &kinematics);

    /// Projection, at the quadrature points, of quantities with the values @p at_points (quadrature points x
    /// quantities).
    Eigen::MatrixXd projected(const Eigen::MatrixXd &at_points) const
    {
      return basis * (to_coefficients * at_points);
    }

    /// The projection at arbitrary points x of the cell of the last reinit().
    Eigen::VectorXd projected_at(const Eigen::VectorXd &at_points, const std::vector<dealii::Point<dim>> &x) const;

  private:
    Eigen::RowVectorXd functions(const dealii::Point<dim> &x) const;

    unsigned int       n_functions;
    dealii::Point<dim> center;
    double             length = 1;
    Eigen::MatrixXd    basis;           // quadrature points x functions
    Eigen::MatrixXd    to_coefficients; // functions x quadrature points
  };
} // namespace slipstick::mechanics
