#include <slipstick/base/collective.h>
#include <slipstick/mechanics/cell_stress.h>
#include <slipstick/mechanics/linear_patches.h>
#include <slipstick/mechanics/quadratic_patches.h>
#include <slipstick/mechanics/stress_recovery.h>

#include <deal.II/base/mpi.h>
#include <deal.II/fe/fe_values.h>

#include <memory>

namespace slipstick::mechanics
{
  namespace
  {
    template <int dim>
    StressSamples<dim> samples_of(const StressModel<dim> &on, const Eigen::VectorXd &u)
    {
      const auto           &element = on.element;
      const unsigned int    n       = element.stress.size();
      const unsigned int    n_cells = on.dof_handler.get_triangulation().n_active_cells();
      CellStress<dim>       stress(on, element.stress);
      dealii::FEValues<dim> places(*element.mapping, *element.scalar, element.stress, dealii::update_quadrature_points);
      StressSamples<dim>    samples;
      std::vector<dealii::types::global_dof_index> dofs;
      std::vector<unsigned int>                    nodes;
      samples.stresses.resize(n * n_cells, on.n_components);
      samples.points.reserve(n * n_cells);
      for (const auto &cell : on.dof_handler.active_cell_iterators())
        {
          element.nodes_of(cell, dofs, nodes);
          samples.stresses.middleRows(samples.points.size(), n) = stress.reinit(cell, displacement_at<dim>(nodes, u));
          places.reinit(typename dealii::Triangulation<dim>::cell_iterator(cell)); // only for the points
          for (unsigned int q = 0; q < n; ++q)
            samples.points.push_back(places.quadrature_point(q));
        }
      return samples;
    }

    /// Nodes of subdomain p of this rank that other subdomains also have.
    template <int dim>
    std::vector<unsigned int> shared_nodes(const tfeti::Constraints &constraints, const unsigned int p)
    {
      std::vector<unsigned int> nodes;
      for (const auto &entry : constraints.interface_blocks[p])
        if (entry.dof % dim == 0)
          nodes.push_back(entry.dof / dim);
      return nodes;
    }

    /// Adds the sums of all copies of shared vertices and uses them, dim columns per exchange (an interface node has as
    /// many unknowns).
    template <int dim>
    void finish(const std::vector<PatchSums<dim> *> &sums, const tfeti::Constraints &constraints, const MPI_Comm comm)
    {
      const unsigned int own       = sums.empty() ? 0 : sums.front()->of_shared.cols();
      const unsigned int n_columns = dealii::Utilities::MPI::max(own, comm);
      for (unsigned int first = 0; first < n_columns; first += dim)
        {
          tfeti::DistributedVector shared(constraints.interface_dofs);
          const auto               for_each_copy = [&](const auto &f) {
            for (unsigned int p = 0; p < sums.size(); ++p)
              for (const auto &entry : constraints.interface_blocks[p])
                {
                  const int          row    = sums[p]->row_of(entry.dof / dim);
                  const unsigned int column = first + entry.dof % dim;
                  if (row >= 0 && column < n_columns)
                    f(shared.local_element(entry.interface_dof), sums[p]->of_shared(row, column));
                }
          };
          for_each_copy([](double &all, const double &copy) { all += copy; });
          shared.compress(dealii::VectorOperation::add);
          shared.update_ghost_values();
          for_each_copy([](const double &all, double &copy) { copy = all; });
        }
      for (auto *of_subdomain : sums)
        of_subdomain->finish();
    }

    template <class Patches>
    auto sums_of(const std::vector<std::unique_ptr<Patches>> &patches)
    {
      std::vector<decltype(&patches.front()->sums)> sums;
      for (const auto &patch : patches)
        sums.push_back(&patch->sums);
      return sums;
    }

    template <class Patches>
    std::vector<Eigen::MatrixXd> nodal_of(std::vector<std::unique_ptr<Patches>> &&patches)
    {
      std::vector<Eigen::MatrixXd> nodal;
      for (auto &patch : patches)
        {
          nodal.push_back(patch->nodal());
          patch.reset();
        }
      return nodal;
    }
  } // namespace

  template <int dim>
  std::vector<Eigen::MatrixXd> recover_nodal(const scene::Scene<dim>            &scene,
                                             const mesh::Mesh<dim>              &mesh,
                                             const Spaces<dim>                  &spaces,
                                             const tfeti::Constraints           &constraints,
                                             const std::vector<Eigen::VectorXd> &u,
                                             const double                        t)
  {
    const auto for_all_subdomains = [&](const auto &f) {
      collectively(mesh.comm, [&] { // the temperature formula may fail on one rank only
        for (unsigned int p = 0; p < u.size(); ++p)
          f(StressModel<dim>(scene, mesh, spaces, p, t), u[p], shared_nodes<dim>(constraints, p));
      });
    };
    if (spaces.degree == 1)
      {
        std::vector<std::unique_ptr<LinearPatches<dim>>> patches;
        for_all_subdomains([&](const StressModel<dim> &on, const Eigen::VectorXd &u_p, const auto &shared) {
          patches.push_back(std::make_unique<LinearPatches<dim>>(on.dof_handler, on.element, on.n_components, shared));
          patches.back()->start_fit(samples_of(on, u_p));
        });
        finish(sums_of(patches), constraints, mesh.comm);
        for (unsigned int sides = 0; sides < dim; ++sides)
          {
            for (const auto &patch : patches)
              patch->start_taking(sides);
            finish(sums_of(patches), constraints, mesh.comm);
          }
        return nodal_of(std::move(patches));
      }
    std::vector<std::unique_ptr<QuadraticPatches<dim>>> patches;
    for_all_subdomains([&](const StressModel<dim> &on, const Eigen::VectorXd &u_p, const auto &shared) {
      patches.push_back(
        std::make_unique<QuadraticPatches<dim>>(on.dof_handler, on.element, samples_of(on, u_p), shared));
      patches.back()->start_metrics();
    });
    finish(sums_of(patches), constraints, mesh.comm);
    for (const auto &patch : patches)
      patch->start_fit();
    finish(sums_of(patches), constraints, mesh.comm);
    return nodal_of(std::move(patches));
  }

  template std::vector<Eigen::MatrixXd> recover_nodal(const scene::Scene<2> &,
                                                      const mesh::Mesh<2> &,
                                                      const Spaces<2> &,
                                                      const tfeti::Constraints &,
                                                      const std::vector<Eigen::VectorXd> &,
                                                      const double);
  template std::vector<Eigen::MatrixXd> recover_nodal(const scene::Scene<3> &,
                                                      const mesh::Mesh<3> &,
                                                      const Spaces<3> &,
                                                      const tfeti::Constraints &,
                                                      const std::vector<Eigen::VectorXd> &,
                                                      const double);
} // namespace slipstick::mechanics
