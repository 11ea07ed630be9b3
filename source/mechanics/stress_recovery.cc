#include <slipstick/base/collective.h>
#include <slipstick/mechanics/cell_stress.h>
#include <slipstick/mechanics/patch_recovery.h>
#include <slipstick/mechanics/stress_recovery.h>

#include <deal.II/base/mpi.h>

#include <algorithm>
#include <memory>

namespace slipstick::mechanics
{
  namespace
  {
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
    Eigen::MatrixXd weighted_stress(const StressModel<dim> &on, const Eigen::VectorXd &u, PatchRecovery<dim> *patches)
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

  } // namespace

  template <int dim>
  std::vector<Eigen::MatrixXd> recover_nodal(const scene::Scene<dim>            &scene,
                                             const mesh::Mesh<dim>              &mesh,
                                             const Spaces<dim>                  &spaces,
                                             const tfeti::Constraints           &constraints,
                                             const std::vector<Eigen::VectorXd> &u,
                                             const double                        t)
  {
    const unsigned int           n_components = mesh::Kinematics<dim>(scene.plane_state).n_stress_components();
    const unsigned int           n            = u.size();
    std::vector<Eigen::MatrixXd> sums;
    std::vector<std::unique_ptr<PatchRecovery<dim>>> patches(n);
    collectively(mesh.comm, [&] { // the temperature formula may fail on one rank only
      for (unsigned int p = 0; p < n; ++p)
        {
          if (needs_patches(spaces.of(p)))
            patches[p] = std::make_unique<PatchRecovery<dim>>(*spaces.dof_handlers[p], n_components);
          sums.push_back(weighted_stress(StressModel<dim>(scene, mesh, spaces, p, t), u[p], patches[p].get()));
        }
    });
    std::vector<Eigen::MatrixXd *> of_means, of_patches;
    for (unsigned int p = 0; p < n; ++p)
      {
        of_means.push_back(&sums[p]);
        of_patches.push_back(patches[p] ? &patches[p]->sums : nullptr);
      }
    add_copies<dim>(constraints, of_means, n_components + 1);
    const bool any_patches =
      std::any_of(patches.begin(), patches.end(), [](const auto &patch) { return patch != nullptr; });
    if (dealii::Utilities::MPI::max(any_patches ? 1 : 0, mesh.comm) > 0)
      add_copies<dim>(constraints, of_patches, PatchRecovery<dim>::n_sums(n_components));
    for (unsigned int p = 0; p < n; ++p)
      {
        Eigen::MatrixXd nodal = sums[p].leftCols(n_components).array().colwise() / sums[p].col(n_components).array();
        if (patches[p])
          patches[p]->recover(nodal);
        sums[p].swap(nodal);
        patches[p].reset();
      }
    return sums;
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
