#include <slipstick/base/collective.h>
#include <slipstick/mechanics/cell_values.h>
#include <slipstick/mechanics/dilatation.h>
#include <slipstick/mechanics/elasticity.h>
#include <slipstick/mechanics/patch_recovery.h>
#include <slipstick/mechanics/spaces.h>
#include <slipstick/mechanics/stress.h>
#include <slipstick/mesh/kinematics.h>

#include <deal.II/base/mpi.h>
#include <deal.II/dofs/dof_tools.h>

#include <limits>

namespace slipstick::mechanics
{
  namespace
  {
    /// Data that one subdomain needs repeatedly.
    template <int dim>
    struct Subdomain
    {
      Subdomain(const scene::Scene<dim> &scene,
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

      const Element<dim>            &element;
      const dealii::DoFHandler<dim> &dof_handler;
      double                         thickness;
      mesh::Kinematics<dim>          kinematics;
      ElasticLaw                     law;
      TemperatureOfBody<dim>         temperature;
      bool                           project;      // the dilatation
      unsigned int                   n_components; // xx, yy, xy, of bodies of revolution hoop; in space all six
    };

    /// Stresses of the displacement at the points of a rule, cell by cell.
    template <int dim>
    class CellStress
    {
    public:
      CellStress(const Subdomain<dim> &on_, const dealii::Quadrature<dim> &points)
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

      /// @p u: displacement at the nodes of the cell, dim x nodes. @return points x (xx, yy, xy, of bodies of
      /// revolution hoop).
      const Eigen::MatrixXd &reinit(const typename CellValues<dim>::Cell &cell, const Eigen::MatrixXd &u)
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

      double JxW(const unsigned int q) const
      {
        return (*values).JxW(q);
      }

      /// JxW times thickness or circumference.
      double weight(const unsigned int q) const
      {
        const double in_plane = (*values).JxW(q) * on.thickness;
        return on.kinematics.is_revolution() ? in_plane * on.kinematics.measure(values.point(q)) : in_plane;
      }

    private:
      dealii::UpdateFlags flags() const
      {
        if (on.kinematics.is_revolution())
          return dealii::update_quadrature_points | dealii::update_values;
        return on.project || !on.temperature.is_zero() ? dealii::update_quadrature_points : dealii::update_default;
      }

      double hoop_strain_at(const CellValues<dim> &at, const unsigned int q, const Eigen::MatrixXd &u) const
      {
        if (!on.kinematics.is_revolution())
          return 0;
        double u_x = 0;
        for (unsigned int i = 0; i < u.cols(); ++i)
          u_x += u(0, i) * (*at).shape_value(i, q);
        return on.kinematics.hoop_strain(u_x, at.point(q));
      }

      static dealii::Tensor<2, dim> gradient_at(const dealii::FEValues<dim> &values,
                                                const unsigned int           q,
                                                const Eigen::MatrixXd       &u)
      {
        dealii::Tensor<2, dim> sum;
        for (unsigned int i = 0; i < values.dofs_per_cell; ++i)
          for (unsigned int c = 0; c < dim; ++c)
            sum[c] += u(c, i) * values.shape_grad(i, q);
        return sum;
      }

      /// As in the stiffness: projected from the points of its rule, then evaluated at the points of this rule.
      void project_dilatation(const typename CellValues<dim>::Cell &cell, const Eigen::MatrixXd &u)
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

      const Subdomain<dim>           &on;
      CellValues<dim>                 values;
      std::optional<CellValues<dim>>  all_values; // at the points of the stiffness rule, for the projection
      DilatationProjection<dim>       projection;
      Eigen::MatrixXd                 stress;
      Eigen::VectorXd                 dilatation, temperature;
      dealii::Quadrature<dim>         rule; // of the stiffness
      Eigen::VectorXd                 of_projection;
      std::vector<dealii::Point<dim>> real_points;
    };

    template <int dim>
    Eigen::MatrixXd displacement_at(const std::vector<unsigned int> &nodes, const Eigen::VectorXd &u)
    {
      Eigen::MatrixXd local(dim, nodes.size());
      for (unsigned int i = 0; i < nodes.size(); ++i)
        for (unsigned int c = 0; c < dim; ++c)
          local(c, i) = u[dim * nodes[i] + c];
      return local;
    }

    /// Values at the nodes of a cell from values at the points of Element::stress, by the polynomial of one degree less
    /// through those points; on tetrahedra, which have more points than coefficients, by least squares.
    template <int dim>
    Eigen::MatrixXd extrapolation_to_nodes(const Element<dim> &element)
    {
      const auto        &points      = element.stress;
      const bool         is_linear   = dim == 3 && element.cell.is_simplex();
      const unsigned int n_functions = is_linear ? std::min(dim + 1u, points.size()) : points.size();
      Eigen::MatrixXd    at_points(points.size(), n_functions), at_nodes(element.n_nodes(), n_functions);
      const auto         monomials = [&](const dealii::Point<dim> &x, auto &&row) {
        std::array<double, 8> values{{1, x[0], x[1], x[0] * x[1]}}; // constant; linear; bilinear; trilinear
        if (is_linear)
          values[3] = x[dim - 1];
        else
          for (unsigned int k = 0; k < 4 && dim == 3; ++k)
            values[4 + k] = values[k] * x[dim - 1];
        for (unsigned int k = 0; k < n_functions; ++k)
          row[k] = values[k];
      };
      for (unsigned int q = 0; q < points.size(); ++q)
        monomials(points.point(q), at_points.row(q));
      for (unsigned int i = 0; i < element.n_nodes(); ++i)
        monomials(element.scalar->unit_support_point(i), at_nodes.row(i));
      if (n_functions < points.size())
        return at_nodes * at_points.completeOrthogonalDecomposition().pseudoInverse();
      return at_nodes * at_points.inverse();
    }

    /// Sums over the cells around every node: area times stress, area (last column). Also passes the stresses to @p
    /// patches, if given.
    template <int dim>
    Eigen::MatrixXd weighted_stress(const Subdomain<dim> &on, const Eigen::VectorXd &u, PatchRecovery<dim> *patches)
    {
      const auto                                  &element       = on.element;
      const auto                                  &points        = element.stress;
      const unsigned int                           n_components  = on.n_components;
      const Eigen::MatrixXd                        extrapolation = extrapolation_to_nodes(element);
      CellStress<dim>                              stress(on, points);
      Eigen::MatrixXd                              sums = Eigen::MatrixXd::Zero(u.size() / dim, n_components + 1);
      std::vector<dealii::types::global_dof_index> dofs;
      std::vector<unsigned int>                    nodes;
      std::vector<dealii::Point<dim>>              positions(points.size());
      for (const auto &cell : on.dof_handler.active_cell_iterators())
        {
          element.nodes_of(cell, dofs, nodes);
          const auto &at_points = stress.reinit(cell, displacement_at<dim>(nodes, u));
          if (patches)
            {
              for (unsigned int q = 0; q < points.size(); ++q)
                positions[q] = element.mapping->transform_unit_to_real_cell(cell, points.point(q));
              patches->add(cell, positions, at_points);
            }
          double area = 0;
          for (unsigned int q = 0; q < points.size(); ++q)
            area += stress.JxW(q);
          const Eigen::MatrixXd at_nodes = area * extrapolation * at_points;
          for (unsigned int i = 0; i < nodes.size(); ++i)
            {
              sums.row(nodes[i]).head(n_components) += at_nodes.row(i);
              sums(nodes[i], n_components) += area;
            }
        }
      return sums;
    }

    /// Adds the sums of all copies of shared nodes, dim columns per exchange (an interface node has as many unknowns).
    /// Subdomains without sums have no columns.
    template <int dim>
    void add_copies(const tfeti::Constraints             &constraints,
                    const std::vector<Eigen::MatrixXd *> &sums,
                    const unsigned int                    n_columns)
    {
      for (unsigned int first = 0; first < n_columns; first += dim)
        {
          tfeti::DistributedVector shared(constraints.interface_dofs);
          const auto               has = [&](const unsigned int p, const unsigned int column) {
            return sums[p] && column < n_columns;
          };
          for (unsigned int p = 0; p < sums.size(); ++p)
            for (const auto &entry : constraints.interface_blocks[p])
              if (has(p, first + entry.dof % dim))
                shared.local_element(entry.interface_dof) += (*sums[p])(entry.dof / dim, first + entry.dof % dim);
          shared.compress(dealii::VectorOperation::add);
          shared.update_ghost_values();
          for (unsigned int p = 0; p < sums.size(); ++p)
            for (const auto &entry : constraints.interface_blocks[p])
              if (has(p, first + entry.dof % dim))
                (*sums[p])(entry.dof / dim, first + entry.dof % dim) = shared.local_element(entry.interface_dof);
        }
    }

    /// Whether averages are superconvergent: not on triangles and tetrahedra of degree 2.
    template <int dim>
    bool needs_patches(const Element<dim> &element)
    {
      return element.degree == 2 && element.cell.is_simplex();
    }

    /// Squared energy norms of the computed stress and of its difference from the recovered one.
    template <int dim>
    std::pair<double, double> estimate(const Subdomain<dim> &on, const Eigen::VectorXd &u, SubdomainStress &stress)
    {
      const auto                                  &element = on.element;
      const dealii::Quadrature<dim>                points  = element.cell_quadrature(element.degree + 1);
      CellStress<dim>                              computed(on, points);
      std::vector<dealii::types::global_dof_index> dofs;
      std::vector<unsigned int>                    nodes;
      Eigen::MatrixXd                              shapes(points.size(), element.n_nodes());
      for (unsigned int q = 0; q < points.size(); ++q)
        for (unsigned int i = 0; i < shapes.cols(); ++i)
          shapes(q, i) = element.scalar->shape_value(i, points.point(q));
      std::pair<double, double> squares{0, 0};
      stress.error.resize(on.dof_handler.get_triangulation().n_active_cells());
      for (const auto &cell : on.dof_handler.active_cell_iterators())
        {
          element.nodes_of(cell, dofs, nodes);
          const auto &at_points = computed.reinit(cell, displacement_at<dim>(nodes, u));
          double      error     = 0;
          for (unsigned int q = 0; q < points.size(); ++q)
            {
              Stress<dim> at_point = Stress<dim>::Zero(), difference = Stress<dim>::Zero();
              at_point.head(on.n_components)   = at_points.row(q).transpose().array();
              difference.head(on.n_components) = -at_points.row(q).transpose().array();
              for (unsigned int i = 0; i < nodes.size(); ++i)
                difference.head(on.n_components) +=
                  shapes(q, i) * stress.nodal.row(nodes[i]).head(on.n_components).transpose().array();
              const double weight = computed.weight(q);
              squares.first += on.law.energy(at_point) * weight;
              error += on.law.energy(difference) * weight;
            }
          stress.error[cell->active_cell_index()] = std::sqrt(error);
          squares.second += error;
        }
      return squares;
    }

    /// Mean stress of the cells around every node, or the stress recovered from patches, with zz. @param sums from
    /// weighted_stress().
    template <int dim>
    Eigen::MatrixXd nodal_stress(const Subdomain<dim>     &on,
                                 const Eigen::MatrixXd    &sums,
                                 const PatchRecovery<dim> *patches)
    {
      const unsigned int n_components = on.n_components;
      Eigen::MatrixXd    nodal(sums.rows(), 2 * dim);
      nodal.leftCols(n_components) = sums.leftCols(n_components).array().colwise() / sums.col(n_components).array();
      if (patches)
        patches->recover(nodal);
      if (on.kinematics.is_revolution() || dim == 3)
        return nodal; // the out-of-plane component is already included
      std::vector<dealii::Point<dim>> positions;
      if (!on.temperature.is_zero())
        {
          positions.resize(on.dof_handler.n_dofs());
          dealii::DoFTools::map_dofs_to_support_points(*on.element.mapping, on.dof_handler, positions);
        }
      for (unsigned int i = 0; i < nodal.rows(); ++i)
        nodal(i, n_components) =
          on.law.zz(nodal(i, 0), nodal(i, 1), positions.empty() ? 0. : on.temperature(positions[dim * i]));
      return nodal;
    }
  } // namespace

  template <int dim>
  StressResult recover_stress(const scene::Scene<dim>            &scene,
                              const mesh::Mesh<dim>              &mesh,
                              const Spaces<dim>                  &spaces,
                              const tfeti::Constraints           &constraints,
                              const std::vector<Eigen::VectorXd> &u,
                              const double                        t)
  {
    const unsigned int           n_components = mesh::Kinematics<dim>(scene.plane_state).n_stress_components();
    std::vector<Eigen::MatrixXd> sums;
    std::vector<std::unique_ptr<PatchRecovery<dim>>> patches(u.size());
    collectively(mesh.comm, [&] { // the temperature formula may fail on one rank only
      for (unsigned int p = 0; p < u.size(); ++p)
        {
          if (needs_patches(spaces.of(p)))
            patches[p] = std::make_unique<PatchRecovery<dim>>(*spaces.dof_handlers[p], n_components);
          sums.push_back(weighted_stress(Subdomain<dim>(scene, mesh, spaces, p, t), u[p], patches[p].get()));
        }
    });
    std::vector<Eigen::MatrixXd *> of_means, of_patches;
    for (unsigned int p = 0; p < u.size(); ++p)
      {
        of_means.push_back(&sums[p]);
        of_patches.push_back(patches[p] ? &patches[p]->sums : nullptr);
      }
    add_copies<dim>(constraints, of_means, n_components + 1);
    const bool any_patches =
      std::any_of(patches.begin(), patches.end(), [](const auto &patch) { return patch != nullptr; });
    if (dealii::Utilities::MPI::max(any_patches ? 1 : 0, mesh.comm) > 0)
      add_copies<dim>(constraints, of_patches, PatchRecovery<dim>::n_sums(n_components));

    StressResult result;
    result.has_hoop_stress = mesh::Kinematics<dim>(scene.plane_state).is_revolution();
    double min_zz = std::numeric_limits<double>::max(), max_zz = std::numeric_limits<double>::lowest();
    collectively(mesh.comm, [&] {
      for (unsigned int p = 0; p < u.size(); ++p)
        {
          const Subdomain<dim> on(scene, mesh, spaces, p, t);
          SubdomainStress      stress;
          stress.nodal = nodal_stress(on, sums[p], patches[p].get());
          sums[p].resize(0, 0);
          patches[p].reset();
          for (unsigned int i = 0; i < stress.nodal.rows(); ++i)
            {
              const auto s         = stress.nodal.row(i);
              result.max_von_mises = std::max(result.max_von_mises, von_mises<dim>(s));
              min_zz               = std::min(min_zz, s[3]);
              max_zz               = std::max(max_zz, s[3]);
            }
          const auto [energy, error] = estimate(on, u[p], stress);
          result.energy_squared += energy;
          result.error_squared += error;
          result.subdomains.push_back(std::move(stress));
        }
    });
    if (result.has_hoop_stress)
      {
        result.min_hoop_stress = dealii::Utilities::MPI::min(min_zz, mesh.comm);
        result.max_hoop_stress = dealii::Utilities::MPI::max(max_zz, mesh.comm);
      }
    result.max_von_mises  = dealii::Utilities::MPI::max(result.max_von_mises, mesh.comm);
    result.energy_squared = dealii::Utilities::MPI::sum(result.energy_squared, mesh.comm);
    result.error_squared  = dealii::Utilities::MPI::sum(result.error_squared, mesh.comm);
    return result;
  }

  template StressResult recover_stress(const scene::Scene<2> &,
                                       const mesh::Mesh<2> &,
                                       const Spaces<2> &,
                                       const tfeti::Constraints &,
                                       const std::vector<Eigen::VectorXd> &,
                                       const double);
  template StressResult recover_stress(const scene::Scene<3> &,
                                       const mesh::Mesh<3> &,
                                       const Spaces<3> &,
                                       const tfeti::Constraints &,
                                       const std::vector<Eigen::VectorXd> &,
                                       const double);
} // namespace slipstick::mechanics
