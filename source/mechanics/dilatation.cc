#include <slipstick/mechanics/dilatation.h>

namespace slipstick::mechanics
{
  template <int dim>
  void DilatationProjection<dim>::reinit(const CellValues<dim> &at, const mesh::Kinematics<dim> &kinematics)
  {
    const auto        &values = *at;
    const auto        &points = values.get_quadrature_points();
    const unsigned int n      = points.size();
    center                    = dealii::Point<dim>();
    for (const auto &x : points)
      center += x / static_cast<double>(n);
    length = 0;
    for (const auto &x : points)
      length = std::max(length, x.distance(center));
    if (length == 0) // one point
      length = 1;
    basis.resize(n, n_functions);
    Eigen::MatrixXd weighted(n_functions, n);
    for (unsigned int q = 0; q < n; ++q)
      {
        basis.row(q)    = functions(points[q]);
        weighted.col(q) = basis.row(q).transpose() * (values.JxW(q) * kinematics.measure(at.point(q)));
      }
    to_coefficients = (weighted * basis).ldlt().solve(weighted);
  }

  template <int dim>
  Eigen::VectorXd DilatationProjection<dim>::projected_at(const Eigen::VectorXd                 &at_points,
                                                          const std::vector<dealii::Point<dim>> &x) const
  {
    const Eigen::VectorXd coefficients = to_coefficients * at_points;
    Eigen::VectorXd       result(x.size());
    for (unsigned int k = 0; k < x.size(); ++k)
      result[k] = functions(x[k]).dot(coefficients);
    return result;
  }

  template <int dim>
  Eigen::RowVectorXd DilatationProjection<dim>::functions(const dealii::Point<dim> &x) const
  {
    Eigen::RowVectorXd values = Eigen::RowVectorXd::Ones(n_functions);
    for (unsigned int k = 1; k < n_functions; ++k)
      values[k] = (x[k - 1] - center[k - 1]) / length;
    return values;
  }

  template class DilatationProjection<2>;
  template class DilatationProjection<3>;
} // namespace slipstick::mechanics
