// Finite element spaces on the subdomains and the nodes that they share.
#pragma once

#include <slipstick/fem/mesh.h>

#include <deal.II/dofs/dof_handler.h>
#include <deal.II/fe/fe_q.h>
#include <deal.II/fe/fe_system.h>
#include <deal.II/fe/mapping_q.h>

#include <array>

namespace slipstick::fem
{
  /// Identity of a node across subdomains and ranks: its vertex twice, or the two vertices of its edge.
  using NodeKey = std::array<GlobalVertex, 2>;

  /// Displacement space of every subdomain of this rank. The unknowns of node i are dim * i ... dim * i + dim - 1.
  template <int dim>
  struct Spaces
  {
    Spaces(const Mesh<dim> &mesh, const unsigned int degree);

    dealii::FE_Q<dim>                                     scalar_element;
    dealii::FESystem<dim>                                 element;
    dealii::MappingQ<dim>                                 mapping;
    std::vector<std::unique_ptr<dealii::DoFHandler<dim>>> dof_handlers; // by subdomain of this rank
    unsigned long long                                    n_dofs = 0;   // over all ranks and subdomains

    /// Calls f(node, key, position) for the nodes of a face, in deal.II's order of the face.
    template <class F>
    void for_each_face_node(const SubdomainMesh<dim>                                     &mesh,
                            const typename dealii::DoFHandler<dim>::active_face_iterator &face,
                            const F                                                      &f) const
    {
      std::array<GlobalVertex, 2> ends;
      for (unsigned int v = 0; v < 2; ++v)
        {
          ends[v] = mesh.global_vertices[face->vertex_index(v)];
          f(face->vertex_dof_index(v, 0) / dim, NodeKey{{ends[v], ends[v]}}, face->vertex(v));
        }
      for (unsigned int k = 0; k + 1 < element.degree; ++k)
        f(face->dof_index(k * dim) / dim,
          NodeKey{{std::min(ends[0], ends[1]), std::max(ends[0], ends[1])}},
          face->center());
    }
  };
} // namespace slipstick::fem
