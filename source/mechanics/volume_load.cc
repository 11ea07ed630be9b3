#include <slipstick/mechanics/cell_values.h>
#include <slipstick/mechanics/dilatation.h>
#include <slipstick/mechanics/elasticity.h>
#include <slipstick/mechanics/volume_load.h>

#include <deal.II/base/quadrature_lib.h>

#include <algorithm>

namespace slipstick::mechanics
{
  namespace
  {
    // Points per direction of the finer quadrature used to check body forces. On tetrahedra deal.II has no rules beyond
    // the second: a larger number gives one without points.
    constexpr unsigned int finer_order = 6, finer_order_of_tetrahedra = 5;

    template <int dim>
    bool is_constant(const scene::BodyForce<dim> &load)
    {
      const auto all_constant = [](const auto &fields) {
        return std::all_of(fields.begin(), fields.end(), [](const auto &field) { return field.is_constant(); });
      };
      return all_constant(load.force) && all_constant(load.acceleration) && load.angular_velocity.is_constant();
    }

    template <int dim>
    void add(Eigen::VectorXd &load, const unsigned int node, const dealii::Tensor<1, dim> &force)
    {
      for (unsigned int c = 0; c < dim; ++c)
        load[dim * node + c] += force[c];
    }
  } // namespace

  template <int dim>
  VolumeLoad<dim>::VolumeLoad(const scene::Scene<dim> &scene_,
                              const mesh::Mesh<dim>   &mesh,
                              const Spaces<dim>       &spaces,
                              const unsigned int       p,
                              const double             t_)
    : scene(scene_)
    , element(spaces.of(p))
    , dof_handler(*spaces.dof_handlers[p])
    , number(mesh.subdomains[p]->body)
    , body(scene.bodies[number])
    , kinematics(scene.plane_state)
    , t(t_)
  {
    for (unsigned int k = 0; k < scene.body_forces.size(); ++k)
      if (const auto &bodies = scene.body_forces[k].bodies;
          std::find(bodies.begin(), bodies.end(), number) != bodies.end())
        body_forces.push_back(k);
  }

  template <int dim>
  void VolumeLoad<dim>::add_to(Eigen::VectorXd &load, std::vector<LoadResultant> &sums) const
  {
    add_body_forces(load, sums);
    add_thermal_strain(load);
  }

  // Thickness, or circumference at @p x [mm].
  template <int dim>
  double VolumeLoad<dim>::weight(const dealii::Point<dim> &x) const
  {
    return body.thickness * kinematics.measure(x);
  }

  template <int dim>
  typename VolumeLoad<dim>::Vector VolumeLoad<dim>::vector(const std::array<scene::Field<dim>, dim> &fields,
                                                           const dealii::Point<dim>                 &x) const
  {
    Vector v;
    for (unsigned int c = 0; c < dim; ++c)
      v[c] = fields[c].value(x, t);
    return v;
  }

  // Force per volume [N/mm^3].
  template <int dim>
  typename VolumeLoad<dim>::Vector VolumeLoad<dim>::body_force(const scene::BodyForce<dim> &load,
                                                               const dealii::Point<dim>    &x) const
  {
    const double density = scene.materials[body.material].density;
    const double omega   = load.angular_velocity.value(x, t);
    return vector(load.force, x) +
           density * (vector(load.acceleration, x) + omega * omega * kinematics.arm(x, load.axis, load.axis_direction));
  }

  template <int dim>
  void VolumeLoad<dim>::add_body_forces(Eigen::VectorXd &load, std::vector<LoadResultant> &sums) const
  {
    if (body_forces.empty())
      return;
    std::vector<dealii::types::global_dof_index> dofs; // of the current cell
    std::vector<unsigned int>                    nodes;
    CellValues<dim>                              values(*element.mapping,
                           *element.scalar,
                           element.loads,
                           dealii::update_values | dealii::update_quadrature_points);
    for (const auto &cell : dof_handler.active_cell_iterators())
      {
        values.reinit(cell);
        element.nodes_of(cell, dofs, nodes);
        for (unsigned int q = 0; q < element.loads.size(); ++q)
          {
            const auto x = values.point(q);
            Vector     force;
            for (const unsigned int k : body_forces)
              {
                const Vector one = body_force(scene.body_forces[k], x) * (*values).JxW(q) * weight(x);
                sums[scene.tractions.size() + k].sum.template add<dim>(one, x);
                force += one;
              }
            for (unsigned int i = 0; i < nodes.size(); ++i)
              add(load, nodes[i], force * (*values).shape_value(i, q));
          }
      }
  }

  // For body forces given by formulas: difference from a finer quadrature.
  template <int dim>
  std::vector<QuadratureDifference> VolumeLoad<dim>::differences() const
  {
    std::vector<QuadratureDifference> result(scene.body_forces.size());
    const bool any = std::any_of(body_forces.begin(), body_forces.end(), [this](const unsigned int k) {
      return !is_constant(scene.body_forces[k]);
    });
    if (!any)
      return result;
    const auto      finer = element.cell.is_simplex() ? dealii::Quadrature<dim>(dealii::QWitherdenVincentSimplex<dim>(
                                                     dim == 3 ? finer_order_of_tetrahedra : finer_order))
                                                      : dealii::Quadrature<dim>(dealii::QGauss<dim>(finer_order));
    CellValues<dim> coarse(*element.mapping, *element.scalar, element.loads, dealii::update_quadrature_points),
      fine(*element.mapping, *element.scalar, finer, dealii::update_quadrature_points);
    for (const auto &cell : dof_handler.active_cell_iterators())
      {
        coarse.reinit(cell);
        fine.reinit(cell);
        for (const unsigned int k : body_forces)
          if (!is_constant(scene.body_forces[k]))
            {
              const auto integral = [&](const CellValues<dim> &values, const unsigned int n) {
                Vector sum;
                for (unsigned int q = 0; q < n; ++q)
                  sum += body_force(scene.body_forces[k], values.point(q)) * (*values).JxW(q) * weight(values.point(q));
                return sum;
              };
              const Vector a = integral(coarse, element.loads.size()), b = integral(fine, finer.size());
              result[k].add(b.norm(), (a - b).norm(), in_space(cell->center()));
            }
      }
    return result;
  }

  // Integral of (lambda e_V T + 2 mu e T) div v; if the dilatation is projected, T in the lambda term is projected,
  // too.
  template <int dim>
  void VolumeLoad<dim>::add_thermal_strain(Eigen::VectorXd &load) const
  {
    const TemperatureOfBody<dim> temperature(scene, number, t);
    if (temperature.is_zero())
      return;
    std::vector<dealii::types::global_dof_index> dofs; // of the current cell
    std::vector<unsigned int>                    nodes;
    const ElasticLaw                             law(scene.materials[body.material], state_of(scene));
    const bool                project = scene.discretization.element == scene::ElementKind::nearly_incompressible;
    DilatationProjection<dim> projection(element);
    const auto                rule = element.stiffness_rule(kinematics);
    CellValues<dim>           values(*element.mapping,
                           *element.scalar,
                           rule,
                           dealii::update_quadrature_points |
                             (kinematics.is_revolution() ? dealii::update_values : dealii::update_default));
    Eigen::VectorXd           change(rule.size()), beside_lambda;
    for (const auto &cell : dof_handler.active_cell_iterators())
      {
        if (const bool is_new = values.reinit(cell); project && (is_new || kinematics.is_revolution()))
          projection.reinit(values, kinematics);
        for (unsigned int q = 0; q < change.size(); ++q)
          change[q] = temperature(values.point(q));
        if (project)
          beside_lambda = projection.projected(change);
        else
          beside_lambda = change;
        element.nodes_of(cell, dofs, nodes);
        for (unsigned int q = 0; q < change.size(); ++q)
          {
            const double stress =
              law.lame.lambda * law.volume_expansion * beside_lambda[q] + 2 * law.lame.mu * law.expansion * change[q];
            const auto   x         = values.point(q);
            const double of_volume = stress * (*values).JxW(q) * weight(x);
            for (unsigned int i = 0; i < nodes.size(); ++i)
              {
                Vector dilatation = (*values).shape_grad(i, q);
                if (kinematics.is_revolution())
                  dilatation[0] += kinematics.hoop_strain((*values).shape_value(i, q), x);
                add(load, nodes[i], of_volume * dilatation);
              }
          }
      }
  }

  template class VolumeLoad<2>;
  template class VolumeLoad<3>;
} // namespace slipstick::mechanics
