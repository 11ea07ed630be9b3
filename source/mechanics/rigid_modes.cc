#include <slipstick/base/turned.h>
#include <slipstick/mechanics/rigid_modes.h>

#include <deal.II/base/mpi.h>
#include <deal.II/fe/fe_system.h>

#include <limits>

namespace slipstick::mechanics
{
  namespace
  {
    template <int dim>
    std::vector<dealii::Point<dim>> positions_of_unknowns(const Element<dim>            &element,
                                                          const dealii::DoFHandler<dim> &dof_handler)
    {
      std::vector<dealii::Point<dim>>              points(dof_handler.n_dofs());
      std::vector<dealii::types::global_dof_index> dofs;
      std::vector<unsigned int>                    nodes;
      for (const auto &cell : dof_handler.active_cell_iterators())
        {
          element.nodes_of(cell, dofs, nodes);
          for (unsigned int i = 0; i < nodes.size(); ++i) // the vertices come first
            std::fill_n(points.begin() + dim * nodes[i],
                        dim,
                        i < cell->n_vertices()
                          ? cell->vertex(i)
                          : element.mapping->transform_unit_to_real_cell(cell, element.scalar->unit_support_point(i)));
        }
      return points;
    }
  } // namespace

  template <int dim>
  std::vector<Frame<dim>> body_frames(const scene::Scene<dim> &scene, const mesh::Mesh<dim> &mesh)
  {
    const unsigned int  n = scene.bodies.size();
    std::vector<double> low(n * dim, std::numeric_limits<double>::max()), minus_high(low);
    for (const auto &subdomain : mesh.subdomains)
      for (const auto &x : subdomain->triangulation.get_vertices())
        for (unsigned int d = 0; d < dim; ++d)
          {
            double &l = low[subdomain->body * dim + d], &h = minus_high[subdomain->body * dim + d];
            l = std::min(l, x[d]);
            h = std::min(h, -x[d]);
          }
    dealii::Utilities::MPI::min(low, mesh.comm, low);
    dealii::Utilities::MPI::min(minus_high, mesh.comm, minus_high);
    std::vector<Frame<dim>> frames(n);
    for (unsigned int b = 0; b < n; ++b)
      {
        dealii::Tensor<1, dim> diagonal;
        for (unsigned int d = 0; d < dim; ++d)
          {
            frames[b].center[d] = (low[b * dim + d] - minus_high[b * dim + d]) / 2;
            diagonal[d]         = -minus_high[b * dim + d] - low[b * dim + d];
          }
        frames[b].length = diagonal.norm() / 2;
      }
    return frames;
  }

  template <int dim>
  void rigid_modes(const Element<dim>            &element,
                   const dealii::DoFHandler<dim> &dof_handler,
                   const Frame<dim>              &body,
                   const mesh::Kinematics<dim>   &kinematics,
                   tfeti::SubdomainMatrices      &system)
  {
    const auto points = positions_of_unknowns(element, dof_handler);
    system.positions.resize(dim, points.size() / dim);
    for (unsigned int i = 0; i < points.size(); ++i)
      system.positions(i % dim, i / dim) = points[i][i % dim];
    for (unsigned int d = 0; d < dim; ++d)
      system.frame.center[d] = body.center[d];
    system.frame.length  = body.length;
    const unsigned int k = kinematics.n_rigid_motions();
    system.kernel        = Eigen::MatrixXd::Zero(points.size(), k);
    system.body_modes    = Eigen::MatrixXd::Identity(k, k);
    if (kinematics.is_revolution())
      {
        for (unsigned int i = 1; i < points.size(); i += dim) // along the axis, y
          system.kernel(i, 0) = 1;
        return;
      }

    Frame<dim> own;
    for (const auto &x : points)
      own.center += x / static_cast<double>(points.size());
    double squares = 0;
    for (const auto &x : points)
      squares += x.distance_square(own.center);
    own.length = std::sqrt(squares / points.size());

    for (unsigned int i = 0; i < points.size(); ++i)
      {
        const dealii::Tensor<1, dim> r = (points[i] - own.center) / own.length;
        system.kernel(i, i % dim)      = 1;
        for (unsigned int m = dim; m < k; ++m)
          system.kernel(i, m) = turned(r)[m - dim][i % dim];
      }
    // rotation about the body's centre = scaled own rotation + translation of the own centre
    const dealii::Tensor<1, dim> offset = (own.center - body.center) / body.length;
    for (unsigned int m = dim; m < k; ++m)
      {
        const dealii::Tensor<1, dim> moved = turned(offset)[m - dim];
        for (unsigned int d = 0; d < dim; ++d)
          system.body_modes(d, m) = moved[d];
        system.body_modes(m, m) = own.length / body.length;
      }
  }

  template std::vector<Frame<2>> body_frames(const scene::Scene<2> &, const mesh::Mesh<2> &);
  template void                  rigid_modes(const Element<2> &,
                                             const dealii::DoFHandler<2> &,
                                             const Frame<2> &,
                                             const mesh::Kinematics<2> &,
                                             tfeti::SubdomainMatrices &);
  template std::vector<Frame<3>> body_frames(const scene::Scene<3> &, const mesh::Mesh<3> &);
  template void                  rigid_modes(const Element<3> &,
                                             const dealii::DoFHandler<3> &,
                                             const Frame<3> &,
                                             const mesh::Kinematics<3> &,
                                             tfeti::SubdomainMatrices &);
} // namespace slipstick::mechanics
