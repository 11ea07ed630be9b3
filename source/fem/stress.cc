#include <slipstick/fem/assembly.h>
#include <slipstick/fem/cell_values.h>
#include <slipstick/fem/stress.h>

#include <deal.II/base/mpi.h>

namespace slipstick::fem
{
  namespace
  {
    constexpr unsigned int n_components = 3; // xx, yy, xy

    using Stress = Eigen::Array3d;

    /// What one subdomain needs again and again.
    template <int dim>
    struct Body
    {
      LameCoefficients lame;
      double           thickness;

      Stress stress(const dealii::Tensor<2, dim> &gradient) const
      {
        const double divergence = trace(gradient);
        return {lame.lambda * divergence + 2 * lame.mu * gradient[0][0],
                lame.lambda * divergence + 2 * lame.mu * gradient[1][1],
                lame.mu * (gradient[0][1] + gradient[1][0])};
      }

      /// sigma : C^-1 : sigma
      double energy(const Stress &s) const
      {
        const double mean = lame.lambda / (2 * (lame.lambda + lame.mu)) * (s[0] + s[1]);
        return (s[0] * (s[0] - mean) + s[1] * (s[1] - mean) + 2 * s[2] * s[2]) / (2 * lame.mu);
      }
    };

    template <int dim>
    Body<dim> body_of(const scene::Scene<dim> &scene, const unsigned int body)
    {
      return {lame_coefficients(scene.materials[scene.bodies[body].material], scene.plane_state),
              scene.bodies[body].thickness};
    }

    /// Displacement gradient at point q; u at the cell's nodes.
    template <int dim>
    dealii::Tensor<2, dim> gradient(const dealii::FEValues<dim> &values, const unsigned int q, const Eigen::MatrixXd &u)
    {
      dealii::Tensor<2, dim> sum;
      for (unsigned int i = 0; i < values.dofs_per_cell; ++i)
        for (unsigned int c = 0; c < dim; ++c)
          sum[c] += u(c, i) * values.shape_grad(i, q);
      return sum;
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

    /// From values at the points of Element::stress to values at the nodes of a cell, by the polynomial of one degree
    /// less through those points.
    template <int dim>
    Eigen::MatrixXd extrapolation_to_nodes(const Element<dim> &element)
    {
      const auto     &points = element.stress;
      Eigen::MatrixXd at_points(points.size(), points.size()), at_nodes(element.n_nodes(), points.size());
      const auto      monomials = [&](const dealii::Point<dim> &x, auto &&row) {
        const std::array<double, 4> values{{1, x[0], x[1], x[0] * x[1]}}; // constant; linear; bilinear
        for (unsigned int k = 0; k < points.size(); ++k)
          row[k] = values[k];
      };
      for (unsigned int q = 0; q < points.size(); ++q)
        monomials(points.point(q), at_points.row(q));
      for (unsigned int i = 0; i < element.n_nodes(); ++i)
        monomials(element.scalar->unit_support_point(i), at_nodes.row(i));
      return at_nodes * at_points.inverse();
    }

    /// Sums over cells around every node: area times stress, area (last column).
    template <int dim>
    Eigen::MatrixXd weighted_stress(const Body<dim>               &body,
                                    const Element<dim>            &element,
                                    const dealii::DoFHandler<dim> &dof_handler,
                                    const Eigen::VectorXd         &u)
    {
      const auto                                  &points        = element.stress;
      const Eigen::MatrixXd                        extrapolation = extrapolation_to_nodes(element);
      CellValues<dim>                              values(*element.mapping, *element.scalar, points);
      Eigen::MatrixXd                              sums = Eigen::MatrixXd::Zero(u.size() / dim, n_components + 1);
      std::vector<dealii::types::global_dof_index> dofs;
      std::vector<unsigned int>                    nodes;

      Eigen::MatrixXd at_points(points.size(), n_components);
      for (const auto &cell : dof_handler.active_cell_iterators())
        {
          values.reinit(cell);
          element.nodes_of(cell, dofs, nodes);
          const auto local = displacement_at<dim>(nodes, u);
          double     area  = 0;
          for (unsigned int q = 0; q < points.size(); ++q)
            {
              at_points.row(q) = body.stress(gradient(*values, q, local)).matrix().transpose();
              area += (*values).JxW(q);
            }
          const Eigen::MatrixXd at_nodes = area * extrapolation * at_points;
          for (unsigned int i = 0; i < nodes.size(); ++i)
            {
              sums.row(nodes[i]).template head<n_components>() += at_nodes.row(i);
              sums(nodes[i], n_components) += area;
            }
        }
      return sums;
    }

    /// Adds the sums of all copies of shared nodes, two columns in one exchange (an interface node has dim unknowns).
    template <int dim>
    void add_copies(const tfeti::Constraints &constraints, std::vector<Eigen::MatrixXd> &sums)
    {
      static_assert(dim == 2, "columns travel in pairs");
      for (unsigned int first = 0; first <= n_components; first += dim)
        {
          tfeti::DistributedVector shared(constraints.interface_dofs);
          for (unsigned int p = 0; p < sums.size(); ++p)
            for (const auto &entry : constraints.interface_blocks[p])
              shared.local_element(entry.interface_dof) += sums[p](entry.dof / dim, first + entry.dof % dim);
          shared.compress(dealii::VectorOperation::add);
          shared.update_ghost_values();
          for (unsigned int p = 0; p < sums.size(); ++p)
            for (const auto &entry : constraints.interface_blocks[p])
              sums[p](entry.dof / dim, first + entry.dof % dim) = shared.local_element(entry.interface_dof);
        }
    }

    /// Squared energy norms of the computed stress and of its difference to the recovered one.
    template <int dim>
    std::pair<double, double> estimate(const Body<dim>               &body,
                                       const Element<dim>            &element,
                                       const dealii::DoFHandler<dim> &dof_handler,
                                       const Eigen::VectorXd         &u,
                                       SubdomainStress               &stress)
    {
      const dealii::Quadrature<dim>                points = element.cell_quadrature(element.degree + 1);
      CellValues<dim>                              values(*element.mapping, *element.scalar, points);
      std::vector<dealii::types::global_dof_index> dofs;
      std::vector<unsigned int>                    nodes;
      std::pair<double, double>                    squares{0, 0};
      stress.error.resize(dof_handler.get_triangulation().n_active_cells());
      for (const auto &cell : dof_handler.active_cell_iterators())
        {
          values.reinit(cell);
          element.nodes_of(cell, dofs, nodes);
          const auto local = displacement_at<dim>(nodes, u);
          double     error = 0;
          for (unsigned int q = 0; q < points.size(); ++q)
            {
              const Stress computed  = body.stress(gradient(*values, q, local));
              Stress       recovered = Stress::Zero();
              for (unsigned int i = 0; i < nodes.size(); ++i)
                recovered +=
                  element.scalar->shape_value(i, points.point(q)) * stress.nodal.row(nodes[i]).transpose().array();
              const double weight = (*values).JxW(q) * body.thickness;
              squares.first += body.energy(computed) * weight;
              error += body.energy(recovered - computed) * weight;
            }
          stress.error[cell->active_cell_index()] = std::sqrt(error);
          squares.second += error;
        }
      return squares;
    }
  } // namespace

  double out_of_plane_factor(const scene::Material &material, const scene::PlaneState state)
  {
    return state == scene::PlaneState::plane_strain ? material.poisson_ratio : 0.;
  }

  double von_mises(const double xx, const double yy, const double xy, const double zz)
  {
    return std::sqrt(((xx - yy) * (xx - yy) + (yy - zz) * (yy - zz) + (zz - xx) * (zz - xx)) / 2 + 3 * xy * xy);
  }

  template <int dim>
  StressResult recover_stress(const scene::Scene<dim>            &scene,
                              const Mesh<dim>                    &mesh,
                              const Spaces<dim>                  &spaces,
                              const tfeti::Constraints           &constraints,
                              const std::vector<Eigen::VectorXd> &u)
  {
    std::vector<Eigen::MatrixXd> sums;
    for (unsigned int p = 0; p < u.size(); ++p)
      sums.push_back(
        weighted_stress(body_of(scene, mesh.subdomains[p]->body), spaces.of(p), *spaces.dof_handlers[p], u[p]));
    add_copies<dim>(constraints, sums);

    StressResult result;
    for (unsigned int p = 0; p < u.size(); ++p)
      {
        const unsigned int body = mesh.subdomains[p]->body;
        SubdomainStress    stress;
        stress.nodal = sums[p].leftCols(n_components).array().colwise() / sums[p].col(n_components).array();
        sums[p].resize(0, 0);
        const double zz = out_of_plane_factor(scene.materials[scene.bodies[body].material], scene.plane_state);
        for (unsigned int i = 0; i < stress.nodal.rows(); ++i)
          {
            const auto s         = stress.nodal.row(i);
            result.max_von_mises = std::max(result.max_von_mises, von_mises(s[0], s[1], s[2], zz * (s[0] + s[1])));
          }
        const auto [energy, error] =
          estimate(body_of(scene, body), spaces.of(p), *spaces.dof_handlers[p], u[p], stress);
        result.energy_squared += energy;
        result.error_squared += error;
        result.subdomains.push_back(std::move(stress));
      }
    result.max_von_mises  = dealii::Utilities::MPI::max(result.max_von_mises, mesh.comm);
    result.energy_squared = dealii::Utilities::MPI::sum(result.energy_squared, mesh.comm);
    result.error_squared  = dealii::Utilities::MPI::sum(result.error_squared, mesh.comm);
    return result;
  }

  template StressResult recover_stress(const scene::Scene<2> &,
                                       const Mesh<2> &,
                                       const Spaces<2> &,
                                       const tfeti::Constraints &,
                                       const std::vector<Eigen::VectorXd> &);
} // namespace slipstick::fem
