#include <slipstick/fem/spaces.h>

#include <deal.II/base/mpi.h>

namespace slipstick::fem
{
  template <int dim>
  Spaces<dim>::Spaces(const Mesh<dim> &mesh, const unsigned int degree)
    : scalar_element(degree)
    , element(scalar_element, dim)
    , mapping(degree)
  {
    AssertThrow(degree <= 2, dealii::ExcMessage("a face node is identified by its edge: degree 1 or 2"));
    for (const auto &subdomain : mesh.subdomains)
      {
        dof_handlers.push_back(std::make_unique<dealii::DoFHandler<dim>>(subdomain->triangulation));
        dof_handlers.back()->distribute_dofs(element);
        n_dofs += dof_handlers.back()->n_dofs();
      }
    n_dofs = dealii::Utilities::MPI::sum(n_dofs, mesh.comm);
  }

  template struct Spaces<2>;
} // namespace slipstick::fem
