#include <slipstick/base/collective.h>
#include <slipstick/mechanics/cell_stress.h>
#include <slipstick/mechanics/stress.h>
#include <slipstick/mechanics/stress_recovery.h>

#include <deal.II/base/mpi.h>
#include <deal.II/dofs/dof_tools.h>

#include <limits>

namespace slipstick::mechanics
{
  namespace
  {
    /// Squared energy norms of the computed stress and of its difference from the recovered one.
    template <int dim>
    std::pair<double, double> estimate(const StressModel<dim> &on, const Eigen::VectorXd &u, SubdomainStress &stress)
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

    /// Adds zz to the components of @p recovered.
    template <int dim>
    Eigen::MatrixXd with_zz(const StressModel<dim> &on, Eigen::MatrixXd recovered)
    {
      const unsigned int n_components = on.n_components;
      if (on.kinematics.is_revolution() || dim == 3)
        return recovered; // it is one of them
      Eigen::MatrixXd nodal(recovered.rows(), 2 * dim);
      nodal.leftCols(n_components) = recovered;
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
    auto recovered = recover_nodal(scene, mesh, spaces, constraints, u, t);

    StressResult result;
    result.has_hoop_stress = mesh::Kinematics<dim>(scene.plane_state).is_revolution();
    double min_zz = std::numeric_limits<double>::max(), max_zz = std::numeric_limits<double>::lowest();
    collectively(mesh.comm, [&] {
      for (unsigned int p = 0; p < u.size(); ++p)
        {
          const StressModel<dim> on(scene, mesh, spaces, p, t);
          SubdomainStress        stress;
          stress.nodal = with_zz(on, std::move(recovered[p]));
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
