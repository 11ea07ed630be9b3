#include <slipstick/mechanics/cell_stress.h>

namespace slipstick::mechanics
{
  namespace
  {
    template <int dim>
    dealii::Tensor<2, dim> gradient_at(const dealii::FEValues<dim> &values,
                                       const unsigned int           q,
                                       const Eigen::MatrixXd       &u)
    {
      dealii::Tensor<2, dim> sum;
      for (unsigned int i = 0; i < values.dofs_per_cell; ++i)
        for (unsigned int c = 0; c < dim; ++c)
          sum[c] += u(c, i) * values.shape_grad(i, q);
      return sum;
    }
  } // namespace

  template <int dim>
  StressModel<dim>::StressModel(const scene::Scene<dim> &scene,
                                const mesh::Mesh<dim>   &mesh,
                                const Spaces<dim>       &spaces,
                                const unsigned int       p,
                                const double             t)
    : element(spaces.of(p))
    , dof_handler(*spaces.dof_handlers[p])
    , thickness(scene.bodies[mesh.subdomains[p]->body].thickness)
    , kinematics(scene.plane_state)
    , law(scene.materials[scene.bodies[mesh.subdomains[p]->body].material], state_of(scene))
    , temperature(scene, mesh.subdomains[p]->body, t)
    , project(scene.discretization.element == scene::ElementKind::nearly_incompressible)
    , n_components(kinematics.n_stress_components())
  {}

  template <int dim>
  CellStress<dim>::CellStress(const StressModel<dim> &on_, const dealii::Quadrature<dim> &points)
    : on(on_)
    , values(*on.element.mapping, *on.element.scalar, points, flags())
    , projection(on.element)
    , stress(points.size(), on.n_components)
    , dilatation(points.size())
    , temperature(Eigen::VectorXd::Zero(points.size()))
    , rule(on.element.stiffness_rule(on.kinematics))
    , of_projection(rule.size())
    , real_points(points.size())
  {
    if (on.project)
      all_values.emplace(*on.element.mapping, *on.element.scalar, rule, flags());
  }

  template <int dim>
  const Eigen::MatrixXd &CellStress<dim>::reinit(const typename CellValues<dim>::Cell &cell, const Eigen::MatrixXd &u)
  {
    values.reinit(cell);
    if (!on.temperature.is_zero())
      for (unsigned int q = 0; q < temperature.size(); ++q)
        temperature[q] = on.temperature(values.point(q));
    if (on.project)
      project_dilatation(cell, u);
    for (unsigned int q = 0; q < temperature.size(); ++q)
      {
        const auto   gradient = gradient_at(*values, q, u);
        const double hoop     = hoop_strain_at(values, q, u);
        if (!on.project)
          dilatation[q] = trace(gradient) + hoop - on.law.volume_expansion * temperature[q];
        stress.row(q) =
          on.law.stress(gradient, hoop, dilatation[q], temperature[q]).head(on.n_components).matrix().transpose();
      }
    return stress;
  }

  template <int dim>
  dealii::UpdateFlags CellStress<dim>::flags() const
  {
    if (on.kinematics.is_revolution())
      return dealii::update_quadrature_points | dealii::update_values;
    return on.project || !on.temperature.is_zero() ? dealii::update_quadrature_points : dealii::update_default;
  }

  template <int dim>
  double CellStress<dim>::hoop_strain_at(const CellValues<dim> &at,
                                         const unsigned int     q,
                                         const Eigen::MatrixXd &u) const
  {
    if (!on.kinematics.is_revolution())
      return 0;
    double u_x = 0;
    for (unsigned int i = 0; i < u.cols(); ++i)
      u_x += u(0, i) * (*at).shape_value(i, q);
    return on.kinematics.hoop_strain(u_x, at.point(q));
  }

  template <int dim>
  void CellStress<dim>::project_dilatation(const typename CellValues<dim>::Cell &cell, const Eigen::MatrixXd &u)
  {
    if (all_values->reinit(cell) || on.kinematics.is_revolution())
      projection.reinit(*all_values, on.kinematics);
    for (unsigned int q = 0; q < of_projection.size(); ++q)
      {
        of_projection[q] = trace(gradient_at(**all_values, q, u)) + hoop_strain_at(*all_values, q, u);
        if (!on.temperature.is_zero())
          of_projection[q] -= on.law.volume_expansion * on.temperature(all_values->point(q));
      }
    for (unsigned int q = 0; q < real_points.size(); ++q)
      real_points[q] = (*values).quadrature_point(q); // of the cell for which both were computed
    dilatation = projection.projected_at(of_projection, real_points);
  }

  template <int dim>
  Eigen::MatrixXd displacement_at(const std::vector<unsigned int> &nodes, const Eigen::VectorXd &u)
  {
    Eigen::MatrixXd local(dim, nodes.size());
    for (unsigned int i = 0; i < nodes.size(); ++i)
      for (unsigned int c = 0; c < dim; ++c)
        local(c, i) = u[dim * nodes[i] + c];
    return local;
  }

  template struct StressModel<2>;
  template struct StressModel<3>;
  template class CellStress<2>;
  template class CellStress<3>;
  template Eigen::MatrixXd displacement_at<2>(const std::vector<unsigned int> &, const Eigen::VectorXd &);
  template Eigen::MatrixXd displacement_at<3>(const std::vector<unsigned int> &, const Eigen::VectorXd &);
} // namespace slipstick::mechanics
