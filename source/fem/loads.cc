#include <slipstick/base/collective.h>
#include <slipstick/fem/cell_values.h>
#include <slipstick/fem/dilatation.h>
#include <slipstick/fem/elasticity.h>
#include <slipstick/fem/loads.h>
#include <slipstick/fem/points.h>

#include <algorithm>

namespace slipstick::fem
{
  namespace
  {
    /// One subdomain and its load at load factor t.
    template <int dim>
    class SubdomainLoad
    {
    public:
      SubdomainLoad(const scene::Scene<dim> &scene_,
                    const Mesh<dim>         &mesh_,
                    const Spaces<dim>       &spaces,
                    const unsigned int       p,
                    const double             t_)
        : scene(scene_)
        , mesh(mesh_)
        , element(spaces.of(p))
        , dof_handler(*spaces.dof_handlers[p])
        , number(mesh.subdomains[p]->body)
        , body(scene.bodies[number])
        , t(t_)
        , load(Eigen::VectorXd::Zero(dof_handler.n_dofs()))
      {
        add_tractions();
        add_body_forces();
        add_thermal_strain();
      }

      Eigen::VectorXd take()
      {
        return std::move(load);
      }

    private:
      using Vector = dealii::Tensor<1, dim>;

      void add(const unsigned int node, const Vector &force)
      {
        for (unsigned int c = 0; c < dim; ++c)
          load[dim * node + c] += force[c];
      }

      Vector vector(const std::array<scene::Field<dim>, dim> &fields, const dealii::Point<dim> &x) const
      {
        Vector v;
        for (unsigned int c = 0; c < dim; ++c)
          v[c] = fields[c].value(x, t);
        return v;
      }

      void add_tractions()
      {
        const bool any = std::any_of(scene.tractions.begin(), scene.tractions.end(), [this](const auto &traction) {
          return traction.where.body == number;
        });
        if (!any)
          return;
        dealii::FEFaceValues<dim> values(*element.mapping,
                                         *element.scalar,
                                         element.face_quadrature(element.degree + 2), // loads may be formulas
                                         dealii::update_values | dealii::update_quadrature_points |
                                           dealii::update_normal_vectors | dealii::update_JxW_values);
        for (const auto &cell : dof_handler.active_cell_iterators())
          for (const unsigned int f : cell->face_indices())
            if (cell->face(f)->at_boundary() && cell->face(f)->boundary_id() != cut_id)
              for (const auto &traction : scene.tractions)
                if (traction.where.body == number && mesh.on_boundary(traction.where, cell->face(f)->boundary_id()))
                  {
                    values.reinit(typename dealii::Triangulation<dim>::cell_iterator(cell), f);
                    element.nodes_of(cell, dofs, nodes);
                    add_traction(traction, values);
                  }
      }

      void add_traction(const scene::Traction<dim> &traction, const dealii::FEFaceValues<dim> &values)
      {
        for (unsigned int q = 0; q < values.n_quadrature_points; ++q)
          {
            const auto  &x = values.quadrature_point(q);
            const Vector force =
              (vector(traction.components, x) - traction.pressure.value(x, t) * values.normal_vector(q)) *
              values.JxW(q) * body.thickness;
            for (unsigned int i = 0; i < nodes.size(); ++i)
              add(nodes[i], force * values.shape_value(i, q));
          }
      }

      /// All forces per volume [N/mm^3].
      Vector body_force(const dealii::Point<dim> &x) const
      {
        Vector       sum;
        const double density = scene.materials[body.material].density;
        for (const auto *load : body_forces)
          {
            const double omega = load->angular_velocity.value(x, t);
            sum +=
              vector(load->force, x) + density * (vector(load->acceleration, x) + omega * omega * (x - load->axis));
          }
        return sum;
      }

      void add_body_forces()
      {
        for (const auto &force : scene.body_forces)
          if (std::find(force.bodies.begin(), force.bodies.end(), number) != force.bodies.end())
            body_forces.push_back(&force);
        if (body_forces.empty())
          return;
        CellValues<dim> values(*element.mapping,
                               *element.scalar,
                               element.loads,
                               dealii::update_values | dealii::update_quadrature_points);
        for (const auto &cell : dof_handler.active_cell_iterators())
          {
            values.reinit(cell);
            element.nodes_of(cell, dofs, nodes);
            for (unsigned int q = 0; q < element.loads.size(); ++q)
              {
                const Vector force = body_force(values.point(q)) * (*values).JxW(q) * body.thickness;
                for (unsigned int i = 0; i < nodes.size(); ++i)
                  add(nodes[i], force * (*values).shape_value(i, q));
              }
          }
      }

      /// Integral of (lambda e_V T + 2 mu e T) div v; where the dilatation is projected, T is too beside lambda.
      void add_thermal_strain()
      {
        const TemperatureOfBody<dim> temperature(scene, number, t);
        if (temperature.is_zero())
          return;
        const PlaneLaw            law(scene.materials[body.material], scene.plane_state);
        const bool                project = scene.discretization.element == scene::ElementKind::nearly_incompressible;
        DilatationProjection<dim> projection(element);
        CellValues<dim> values(*element.mapping, *element.scalar, element.stiffness, dealii::update_quadrature_points);
        Eigen::VectorXd change(element.stiffness.size()), beside_lambda;
        for (const auto &cell : dof_handler.active_cell_iterators())
          {
            if (values.reinit(cell) && project)
              projection.reinit(*values);
            for (unsigned int q = 0; q < change.size(); ++q)
              change[q] = temperature(values.point(q));
            if (project)
              beside_lambda = projection.projected(change);
            else
              beside_lambda = change;
            element.nodes_of(cell, dofs, nodes);
            for (unsigned int q = 0; q < change.size(); ++q)
              {
                const double stress = law.lame.lambda * law.volume_expansion * beside_lambda[q] +
                                      2 * law.lame.mu * law.expansion * change[q];
                for (unsigned int i = 0; i < nodes.size(); ++i)
                  add(nodes[i], stress * (*values).JxW(q) * body.thickness * (*values).shape_grad(i, q));
              }
          }
      }

      const scene::Scene<dim>                     &scene;
      const Mesh<dim>                             &mesh;
      const Element<dim>                          &element;
      const dealii::DoFHandler<dim>               &dof_handler;
      unsigned int                                 number;
      const scene::Body<dim>                      &body;
      double                                       t;
      Eigen::VectorXd                              load;
      std::vector<const scene::BodyForce<dim> *>   body_forces; // on this body
      std::vector<dealii::types::global_dof_index> dofs;        // of the present cell
      std::vector<unsigned int>                    nodes;
    };

    template <int dim>
    void add_point_loads(const scene::Scene<dim>      &scene,
                         const Mesh<dim>              &mesh,
                         const Spaces<dim>            &spaces,
                         const double                  t,
                         std::vector<Eigen::VectorXd> &loads)
    {
      std::vector<scene::PointName<dim>> points;
      std::vector<std::string>           owners;
      for (const auto &load : scene.point_loads)
        {
          points.push_back(load.where);
          owners.push_back("Point load " + load.name);
        }
      const auto found = nodes_at(scene, mesh, spaces, points, owners);
      collectively(mesh.comm, [&] {
        for (unsigned int k = 0; k < found.size(); ++k)
          for (unsigned int p = 0; p < mesh.subdomains.size(); ++p)
            if (mesh.subdomains[p]->subdomain == found[k].subdomain)
              for (unsigned int c = 0; c < dim; ++c)
                loads[p][dim * found[k].node + c] += scene.point_loads[k].force[c].value(found[k].position, t);
      });
    }
  } // namespace

  template <int dim>
  std::vector<Eigen::VectorXd> assemble_loads(const scene::Scene<dim> &scene,
                                              const Mesh<dim>         &mesh,
                                              const Spaces<dim>       &spaces,
                                              const double             t)
  {
    std::vector<Eigen::VectorXd> loads;
    collectively(mesh.comm, [&] { // a formula may give no number on one rank alone
      for (unsigned int p = 0; p < mesh.subdomains.size(); ++p)
        loads.push_back(SubdomainLoad<dim>(scene, mesh, spaces, p, t).take());
    });
    if (!scene.point_loads.empty())
      add_point_loads(scene, mesh, spaces, t, loads);
    return loads;
  }

  template std::vector<Eigen::VectorXd> assemble_loads(const scene::Scene<2> &,
                                                       const Mesh<2> &,
                                                       const Spaces<2> &,
                                                       const double);
} // namespace slipstick::fem
