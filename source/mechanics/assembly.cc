#include <slipstick/base/collective.h>
#include <slipstick/base/exceptions.h>
#include <slipstick/mechanics/assembly.h>
#include <slipstick/mechanics/cell_values.h>
#include <slipstick/mechanics/dilatation.h>
#include <slipstick/mechanics/loads.h>
#include <slipstick/mechanics/rigid_modes.h>
#include <slipstick/mechanics/spaces.h>
#include <slipstick/mesh/kinematics.h>

#include <deal.II/dofs/dof_tools.h>
#include <deal.II/fe/fe_values.h>

#include <set>

namespace slipstick::mechanics
{
  namespace
  {
    /// Lower triangle of the pattern, columns sorted, values zero.
    template <int dim>
    Eigen::SparseMatrix<double> lower_pattern(const dealii::DoFHandler<dim> &dof_handler)
    {
      const unsigned int n = dof_handler.n_dofs();
      // neighbours of every node through cells; each component of a node couples with all components of a neighbour
      std::vector<std::vector<unsigned int>>       neighbours(n / dim);
      std::vector<dealii::types::global_dof_index> dofs(dof_handler.get_fe().n_dofs_per_cell());
      std::vector<unsigned int>                    nodes;
      for (const auto &cell : dof_handler.active_cell_iterators())
        {
          cell->get_dof_indices(dofs);
          nodes.clear();
          for (const auto i : dofs)
            if (i % dim == 0)
              nodes.push_back(i / dim);
          for (const unsigned int i : nodes)
            for (const unsigned int j : nodes)
              if (j >= i)
                neighbours[i].push_back(j);
        }
      Eigen::SparseMatrix<double> lower(n, n);
      int                        *begin = lower.outerIndexPtr();
      for (unsigned int i = 0; i < n / dim; ++i)
        {
          std::sort(neighbours[i].begin(), neighbours[i].end());
          neighbours[i].erase(std::unique(neighbours[i].begin(), neighbours[i].end()), neighbours[i].end());
          for (unsigned int c = 0; c < dim; ++c)
            begin[dim * i + c + 1] = begin[dim * i + c] + dim * neighbours[i].size() - c;
        }
      lower.resizeNonZeros(begin[n]);
      int *row = lower.innerIndexPtr();
      for (unsigned int i = 0; i < n / dim; ++i)
        for (unsigned int c = 0; c < dim; ++c)
          for (const unsigned int j : neighbours[i])
            for (unsigned int d = (j == i ? c : 0); d < dim; ++d)
              *row++ = dim * j + d;
      std::fill_n(lower.valuePtr(), begin[n], 0.);
      return lower;
    }

    template <int dim>
    void add_lower(const dealii::FullMatrix<double>                   &local,
                   const std::vector<dealii::types::global_dof_index> &dofs,
                   Eigen::SparseMatrix<double>                        &lower)
    {
      for (unsigned int b = 0; b < dofs.size(); ++b)
        {
          const int *begin = lower.innerIndexPtr() + lower.outerIndexPtr()[dofs[b]];
          const int *end   = lower.innerIndexPtr() + lower.outerIndexPtr()[dofs[b] + 1];
          for (unsigned int a = 0; a < dofs.size(); ++a)
            if (dofs[a] >= dofs[b])
              {
                const int *position = std::lower_bound(begin, end, static_cast<int>(dofs[a]));
                lower.valuePtr()[position - lower.innerIndexPtr()] += local(a, b);
              }
        }
    }

    /// Stiffness of one cell: sum over points of lambda div div + 2 mu eps : eps, times thickness.
    template <int dim>
    void cell_stiffness(const dealii::FEValues<dim> &values,
                        const dealii::FESystem<dim> &element,
                        const LameCoefficients      &lame,
                        const double                 thickness,
                        dealii::FullMatrix<double>  &local)
    {
      const unsigned int n_nodes = values.dofs_per_cell;
      local                      = 0;
      for (unsigned int i = 0; i < n_nodes; ++i)
        for (unsigned int j = 0; j < n_nodes; ++j)
          {
            dealii::Tensor<2, dim> products; // integral of d_c phi_i d_d phi_j
            for (unsigned int q = 0; q < values.n_quadrature_points; ++q)
              products += outer_product(values.shape_grad(i, q), values.shape_grad(j, q)) * values.JxW(q);
            products *= thickness;
            for (unsigned int c = 0; c < dim; ++c)
              for (unsigned int d = 0; d < dim; ++d)
                local(element.component_to_system_index(c, i), element.component_to_system_index(d, j)) =
                  lame.lambda * products[c][d] + lame.mu * products[d][c] + (c == d ? lame.mu * trace(products) : 0.);
          }
    }

    /// Adds the terms of bodies of revolution to the stiffness of the section and weights it: sum over points of lambda
    /// div div + 2 mu eps : eps with the hoop strain in div and eps, times circumference.
    template <int dim>
    void cell_stiffness(const CellValues<dim>       &at,
                        const mesh::Kinematics<dim> &kinematics,
                        const dealii::FESystem<dim> &element,
                        const LameCoefficients      &lame,
                        dealii::FullMatrix<double>  &local)
    {
      const auto        &values  = *at;
      const unsigned int n_nodes = values.dofs_per_cell;
      local                      = 0;
      for (unsigned int q = 0; q < values.n_quadrature_points; ++q)
        {
          const auto   x      = at.point(q);
          const double weight = values.JxW(q) * kinematics.measure(x);
          for (unsigned int i = 0; i < n_nodes; ++i)
            for (unsigned int j = 0; j < n_nodes; ++j)
              {
                const auto  &a = values.shape_grad(i, q), &b = values.shape_grad(j, q);
                const double h_i = kinematics.hoop_strain(values.shape_value(i, q), x),
                             h_j = kinematics.hoop_strain(values.shape_value(j, q), x);
                for (unsigned int c = 0; c < dim; ++c)
                  for (unsigned int d = 0; d < dim; ++d)
                    {
                      const double hoop_i = c == 0 ? h_i : 0., hoop_j = d == 0 ? h_j : 0.;
                      local(element.component_to_system_index(c, i), element.component_to_system_index(d, j)) +=
                        weight * (lame.lambda * (a[c] + hoop_i) * (b[d] + hoop_j) +
                                  lame.mu * (a[d] * b[c] + (c == d ? a * b : 0.) + 2 * hoop_i * hoop_j));
                    }
              }
        }
    }

    /// Adds lambda times the product of the projected dilatations, times thickness or circumference.
    template <int dim>
    void add_projected_dilatation(const CellValues<dim>           &at,
                                  const mesh::Kinematics<dim>     &kinematics,
                                  const dealii::FESystem<dim>     &element,
                                  const DilatationProjection<dim> &projection,
                                  const double                     lambda,
                                  const double                     thickness,
                                  dealii::FullMatrix<double>      &local)
    {
      const auto        &values   = *at;
      const unsigned int n_points = values.n_quadrature_points;
      Eigen::MatrixXd    divergence(n_points, local.m());
      Eigen::VectorXd    weights(n_points);
      for (unsigned int q = 0; q < n_points; ++q)
        {
          weights[q] = values.JxW(q) * kinematics.measure(at.point(q));
          for (unsigned int i = 0; i < values.dofs_per_cell; ++i)
            for (unsigned int c = 0; c < dim; ++c)
              divergence(q, element.component_to_system_index(c, i)) =
                values.shape_grad(i, q)[c] + (c == 0 && kinematics.is_revolution()
                                                ? kinematics.hoop_strain(values.shape_value(i, q), at.point(q))
                                                : 0.);
        }
      const Eigen::MatrixXd dilatation = projection.projected(divergence);
      const Eigen::MatrixXd products = lambda * thickness * dilatation.transpose() * weights.asDiagonal() * dilatation;
      for (unsigned int a = 0; a < local.m(); ++a)
        for (unsigned int b = 0; b < local.n(); ++b)
          local(a, b) += products(a, b);
    }

    template <int dim>
    Eigen::SparseMatrix<double> assemble_stiffness(const scene::Scene<dim>       &scene,
                                                   const unsigned int             body,
                                                   const Element<dim>            &element,
                                                   const dealii::DoFHandler<dim> &dof_handler)
    {
      const auto             lame = lame_coefficients(scene.materials[scene.bodies[body].material], state_of(scene));
      const double           thickness = scene.bodies[body].thickness;
      const bool             project   = scene.discretization.element == scene::ElementKind::nearly_incompressible;
      const LameCoefficients as_displaced{project ? 0. : lame.lambda, lame.mu};
      const mesh::Kinematics<dim>                  kinematics(scene.plane_state);
      DilatationProjection<dim>                    projection(element);
      auto                                         lower = lower_pattern(dof_handler);
      CellValues<dim>                              values(*element.mapping,
                             *element.scalar,
                             element.stiffness_rule(kinematics),
                             kinematics.is_revolution() ? dealii::update_quadrature_points | dealii::update_values
                                                          : project ? dealii::update_quadrature_points
                                                                    : dealii::update_default);
      dealii::FullMatrix<double>                   local(element.vector->n_dofs_per_cell());
      std::vector<dealii::types::global_dof_index> dofs(element.vector->n_dofs_per_cell());
      for (const auto &cell : dof_handler.active_cell_iterators())
        {
          const bool is_new = values.reinit(cell);
          if (is_new || kinematics.is_revolution()) // a translated cell has a different radius
            {
              if (project)
                projection.reinit(values, kinematics);
              if (kinematics.is_revolution())
                cell_stiffness(values, kinematics, *element.vector, as_displaced, local);
              else
                cell_stiffness(*values, *element.vector, as_displaced, thickness, local);
              if (project)
                add_projected_dilatation(values,
                                         kinematics,
                                         *element.vector,
                                         projection,
                                         lame.lambda,
                                         thickness,
                                         local);
            }
          cell->get_dof_indices(dofs);
          add_lower<dim>(local, dofs, lower);
        }
      return lower;
    }

    template <int dim>
    void check_element(const scene::Scene<dim> &scene, const unsigned int body, const Element<dim> &element)
    {
      if (scene.discretization.element == scene::ElementKind::nearly_incompressible && element.cell.is_simplex() &&
          element.degree == 1)
        throw InputError("Discretization/Element = nearly incompressible: body '" + scene.bodies[body].name + "' has " +
                           (dim == 2 ? "triangles" : "tetrahedra") +
                           " of degree 1, which lock however the dilatation is treated",
                         std::string("set Discretization/Degree = 2, or mesh the body with ") +
                           (dim == 2 ? "quadrilaterals" : "hexahedra"));
    }

    /// The volume of every cell (times thickness or circumference) in equal parts at its nodes.
    template <int dim>
    Eigen::VectorXd volumes_of_nodes(const dealii::DoFHandler<dim> &dof_handler,
                                     const mesh::Kinematics<dim>   &kinematics,
                                     const double                   thickness)
    {
      Eigen::VectorXd                              volumes = Eigen::VectorXd::Zero(dof_handler.n_dofs() / dim);
      std::vector<dealii::types::global_dof_index> dofs(dof_handler.get_fe().n_dofs_per_cell());
      for (const auto &cell : dof_handler.active_cell_iterators())
        {
          cell->get_dof_indices(dofs);
          for (const auto dof : dofs)
            if (dof % dim == 0)
              volumes[dof / dim] +=
                thickness * cell->measure() * kinematics.measure(cell->center()) * dim / dofs.size();
        }
      return volumes;
    }

    template <int dim>
    std::vector<unsigned int> boundary_dofs(const dealii::DoFHandler<dim> &dof_handler)
    {
      std::set<unsigned int>                       found;
      std::vector<dealii::types::global_dof_index> dofs(dof_handler.get_fe().n_dofs_per_face());
      for (const auto &cell : dof_handler.active_cell_iterators())
        for (const auto &face : cell->face_iterators())
          if (face->at_boundary())
            {
              face->get_dof_indices(dofs);
              found.insert(dofs.begin(), dofs.end());
            }
      return {found.begin(), found.end()};
    }
  } // namespace

  template <int dim>
  std::vector<tfeti::SubdomainMatrices> assemble(const scene::Scene<dim> &scene,
                                                 const mesh::Mesh<dim>   &mesh,
                                                 const Spaces<dim>       &spaces,
                                                 const double             t)
  {
    collectively(mesh.comm, [&] {
      for (unsigned int p = 0; p < mesh.subdomains.size(); ++p)
        check_element(scene, mesh.subdomains[p]->body, spaces.of(p));
    });
    const auto                            frames = body_frames(scene, mesh);
    auto                                  loads  = assemble_loads(scene, mesh, spaces, t);
    std::vector<tfeti::SubdomainMatrices> systems;
    systems.reserve(mesh.subdomains.size());
    for (unsigned int p = 0; p < mesh.subdomains.size(); ++p)
      {
        const auto              &subdomain   = *mesh.subdomains[p];
        const auto              &dof_handler = *spaces.dof_handlers[p];
        tfeti::SubdomainMatrices system;
        system.subdomain     = subdomain.subdomain;
        system.body          = subdomain.body;
        system.stiffness     = assemble_stiffness(scene, subdomain.body, spaces.of(p), dof_handler);
        system.load          = std::move(loads[p]);
        system.boundary_dofs = boundary_dofs(dof_handler);

        const mesh::Kinematics<dim> kinematics(scene.plane_state);
        system.volumes = volumes_of_nodes(dof_handler, kinematics, scene.bodies[subdomain.body].thickness);
        rigid_modes(spaces.of(p), dof_handler, frames[subdomain.body], kinematics, system);
        systems.push_back(std::move(system));
      }
    return systems;
  }

  template std::vector<tfeti::SubdomainMatrices> assemble(const scene::Scene<2> &,
                                                          const mesh::Mesh<2> &,
                                                          const Spaces<2> &,
                                                          const double);
  template std::vector<tfeti::SubdomainMatrices> assemble(const scene::Scene<3> &,
                                                          const mesh::Mesh<3> &,
                                                          const Spaces<3> &,
                                                          const double);
} // namespace slipstick::mechanics
