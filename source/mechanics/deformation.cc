#include <slipstick/base/gather.h>
#include <slipstick/mechanics/cell_values.h>
#include <slipstick/mechanics/deformation.h>
#include <slipstick/mechanics/rigid_modes.h>
#include <slipstick/mechanics/spaces.h>
#include <slipstick/mesh/kinematics.h>

#include <deal.II/base/mpi.h>
#include <deal.II/base/symmetric_tensor.h>

#include <boost/serialization/vector.hpp>

#include <cmath>

namespace slipstick::mechanics
{
  namespace
  {
    template <int dim>
    void take(Peak<dim> &peak, const double value, const unsigned int body, const dealii::Point<dim> &position)
    {
      if (value > peak.value)
        peak = {value, body, position};
    }

    /// Maximum over the ranks, with the place from the first rank that has it. Collective.
    template <int dim>
    void over_all_ranks(Peak<dim> &peak, const MPI_Comm comm)
    {
      std::vector<double> own{peak.value, static_cast<double>(peak.body)};
      for (unsigned int d = 0; d < dim; ++d)
        own.push_back(peak.position[d]);
      peak = {};
      for (const auto &numbers : all_gather(comm, own))
        {
          dealii::Point<dim> position;
          for (unsigned int d = 0; d < dim; ++d)
            position[d] = numbers[2 + d];
          take(peak, numbers[0], static_cast<unsigned int>(numbers[1]), position);
        }
    }

    /// Largest magnitude of the eigenvalues of the symmetric part.
    double principal_strain(const dealii::Tensor<2, 2> &gradient)
    {
      const double mean = (gradient[0][0] + gradient[1][1]) / 2;
      return std::abs(mean) + std::hypot((gradient[0][0] - gradient[1][1]) / 2, (gradient[0][1] + gradient[1][0]) / 2);
    }

    double principal_strain(const dealii::Tensor<2, 3> &gradient)
    {
      const auto strains = dealii::eigenvalues(dealii::symmetrize(gradient));
      return std::max(std::abs(strains[0]), std::abs(strains[2]));
    }

    /// Rotation angle from the antisymmetric part [rad].
    template <int dim>
    double rotation_of(const dealii::Tensor<2, dim> &gradient)
    {
      if constexpr (dim == 2)
        return std::abs(gradient[1][0] - gradient[0][1]) / 2;
      else
        return std::hypot(gradient[1][0] - gradient[0][1],
                          gradient[2][1] - gradient[1][2],
                          gradient[0][2] - gradient[2][0]) /
               2;
    }

    template <int dim>
    void add_cells(const Element<dim>            &element,
                   const dealii::DoFHandler<dim> &dof_handler,
                   const unsigned int             body,
                   const mesh::Kinematics<dim>   &kinematics,
                   const Eigen::VectorXd         &u,
                   Deformation<dim>              &largest)
    {
      CellValues<dim>                              values(*element.mapping,
                             *element.scalar,
                             element.cell_quadrature(1),
                             kinematics.is_revolution() ? dealii::update_values | dealii::update_quadrature_points
                                                                                     : dealii::update_default);
      std::vector<dealii::types::global_dof_index> dofs;
      std::vector<unsigned int>                    nodes;
      for (const auto &cell : dof_handler.active_cell_iterators())
        {
          values.reinit(cell);
          element.nodes_of(cell, dofs, nodes);
          dealii::Tensor<2, dim> gradient;
          for (unsigned int i = 0; i < nodes.size(); ++i)
            for (unsigned int c = 0; c < dim; ++c)
              gradient[c] += u[dim * nodes[i] + c] * (*values).shape_grad(i, 0);
          double u_x = 0;
          if (kinematics.is_revolution())
            for (unsigned int i = 0; i < nodes.size(); ++i)
              u_x += u[dim * nodes[i]] * (*values).shape_value(i, 0);
          const double hoop   = kinematics.is_revolution() ? kinematics.hoop_strain(u_x, values.point(0)) : 0.;
          const double strain = std::max(principal_strain(gradient), std::abs(hoop)), rotation = rotation_of(gradient);
          if (strain > largest.strain.value)
            largest.strain = {strain, body, cell->center()};
          if (rotation > largest.rotation.value)
            largest.rotation = {rotation, body, cell->center()};
        }
    }

    /// The unknowns of a node are consecutive; nodes inside edges and cells do not affect the extent.
    template <int dim>
    void add_nodes(const dealii::DoFHandler<dim> &dof_handler,
                   const unsigned int             body,
                   const double                   size,
                   const Eigen::VectorXd         &u,
                   Peak<dim>                     &motion)
    {
      const double largest = Eigen::Map<const Eigen::Matrix<double, dim, Eigen::Dynamic>>(u.data(), dim, u.size() / dim)
                               .colwise()
                               .norm()
                               .maxCoeff();
      if (largest <= motion.value * size)
        return;
      for (const auto &cell : dof_handler.active_cell_iterators())
        for (const unsigned int v : cell->vertex_indices())
          take(motion, u.template segment<dim>(cell->vertex_dof_index(v, 0)).norm() / size, body, cell->vertex(v));
    }
  } // namespace

  template <int dim>
  Deformation<dim> largest_deformation(const scene::Scene<dim>            &scene,
                                       const mesh::Mesh<dim>              &mesh,
                                       const Spaces<dim>                  &spaces,
                                       const std::vector<Eigen::VectorXd> &u)
  {
    const auto       frames = body_frames(scene, mesh);
    Deformation<dim> largest;
    for (unsigned int p = 0; p < u.size(); ++p)
      {
        const auto        &subdomain = *mesh.subdomains[p];
        const unsigned int body      = subdomain.body;
        add_cells(spaces.of(p), *spaces.dof_handlers[p], body, mesh::Kinematics<dim>(scene.plane_state), u[p], largest);
        add_nodes(*spaces.dof_handlers[p], body, 2 * frames[body].length, u[p], largest.motion);
      }
    for (Peak<dim> *peak : {&largest.strain, &largest.rotation, &largest.motion})
      over_all_ranks(*peak, mesh.comm);
    return largest;
  }

  template Deformation<2> largest_deformation(const scene::Scene<2> &,
                                              const mesh::Mesh<2> &,
                                              const Spaces<2> &,
                                              const std::vector<Eigen::VectorXd> &);
  template Deformation<3> largest_deformation(const scene::Scene<3> &,
                                              const mesh::Mesh<3> &,
                                              const Spaces<3> &,
                                              const std::vector<Eigen::VectorXd> &);
} // namespace slipstick::mechanics
