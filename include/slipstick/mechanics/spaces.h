// Finite element spaces on the subdomains, and the nodes shared by subdomains.
#pragma once

#include <slipstick/mesh/kinematics.h>
#include <slipstick/mesh/mesh.h>

#include <deal.II/base/quadrature.h>
#include <deal.II/dofs/dof_handler.h>
#include <deal.II/fe/fe_system.h>
#include <deal.II/fe/mapping.h>

#include <array>

namespace slipstick::mechanics
{
  /// Identifies a node across subdomains and ranks: its vertex twice, or the two vertices of its edge; for a node in
  /// the middle of a quadrilateral in space the two vertices of the diagonal that contains the smallest one (a diagonal
  /// is not an edge of a conforming mesh).
  using NodeKey = std::array<mesh::GlobalVertex, 2>;

  /// Lagrange element of one cell type, with its mapping and quadratures. Nodes are at vertices (degree 1) and also at
  /// the midpoints of edges (degree 2; quadrilaterals and hexahedra have one more inside, hexahedra one in every face).
  /// Mappings are isoparametric: for degree 2 the edges follow the manifolds of the triangulation, for quadrilaterals
  /// and triangles alike.
  template <int dim>
  struct Element
  {
    /// @param cell quadrilateral or triangle, hexahedron or tetrahedron. @param degree 1 or 2. @param is_curved whether
    /// the mesh has manifolds to follow.
    Element(const dealii::ReferenceCell cell, const unsigned int degree, const bool is_curved = true);

    dealii::ReferenceCell                             cell;
    unsigned int                                      degree;
    bool                                              is_curved; // otherwise the mapping is of degree 1
    std::unique_ptr<const dealii::FiniteElement<dim>> scalar;
    std::unique_ptr<const dealii::FESystem<dim>>      vector; // dim times scalar
    std::unique_ptr<const dealii::Mapping<dim>>       mapping;
    dealii::Quadrature<dim>                           stiffness; // exact for the stiffness of affine cells
    dealii::Quadrature<dim>                           loads;     // finer: loads may be formulas
    dealii::Quadrature<dim>                           stress;    // at the points where stresses are most accurate

    unsigned int n_nodes() const
    {
      return scalar->n_dofs_per_cell();
    }

    /// Gauss rule of n points per direction (triangles: of the same order).
    dealii::Quadrature<dim> cell_quadrature(const unsigned int n) const;

    /// Rule for the stiffness and related terms. The hoop strain of a body of revolution is not constant on triangles
    /// of degree 1.
    dealii::Quadrature<dim> stiffness_rule(const mesh::Kinematics<dim> &kinematics) const;

    /// Gauss rule with n points for the edges.
    dealii::Quadrature<dim - 1> face_quadrature(const unsigned int n) const;

    /// Nodes of a cell of the displacement space, in the order of the scalar element; @p dofs is scratch.
    void nodes_of(const typename dealii::DoFHandler<dim>::active_cell_iterator &cell,
                  std::vector<dealii::types::global_dof_index>                 &dofs,
                  std::vector<unsigned int>                                    &nodes) const;
  };

  /// Displacement space of every subdomain of this rank. The unknowns of node i are dim * i ... dim * i + dim - 1. All
  /// cells of a subdomain are of one type; subdomains may differ.
  template <int dim>
  struct Spaces
  {
    Spaces(const mesh::Mesh<dim> &mesh, const unsigned int degree);

    unsigned int                                          degree;
    std::vector<std::unique_ptr<dealii::DoFHandler<dim>>> dof_handlers; // by subdomain of this rank
    unsigned long long                                    n_dofs = 0;   // over all ranks and subdomains

    /// The element of subdomain p of this rank.
    const Element<dim> &of(const unsigned int p) const
    {
      return *element_of[p];
    }

    /// Calls f(node, key, position) for the nodes of a face, in deal.II's order for the face (which may be opposite to
    /// the order in the cell from which it is accessed): vertices, midpoints of edges, the centre of a quadrilateral.
    template <class F>
    void for_each_face_node(const mesh::SubdomainMesh<dim>                               &mesh,
                            const typename dealii::DoFHandler<dim>::active_face_iterator &face,
                            const F                                                      &f) const
    {
      constexpr unsigned int                        most_vertices = 2 * (dim - 1); // of edges and quadrilaterals
      std::array<mesh::GlobalVertex, most_vertices> ends;
      for (const unsigned int v : face->vertex_indices())
        {
          ends[v] = mesh.global_vertices[face->vertex_index(v)];
          f(face->vertex_dof_index(v, 0) / dim, NodeKey{{ends[v], ends[v]}}, face->vertex(v));
        }
      if (degree == 1)
        return;
      if constexpr (dim == 2)
        f(face->dof_index(0) / dim,
          key_between(ends[0], ends[1]),
          face->center(true)); // on the manifold of the edge, as for the mapping
      else
        {
          for (unsigned int l = 0; l < face->n_lines(); ++l)
            {
              const auto line = face->line(l);
              f(line->dof_index(0) / dim,
                key_between(mesh.global_vertices[line->vertex_index(0)], mesh.global_vertices[line->vertex_index(1)]),
                line->center(true));
            }
          if (face->n_vertices() == most_vertices) // vertices in lexicographic order: the diagonals are 0, 3 and 1, 2
            f(face->dof_index(0) / dim,
              std::min(key_between(ends[0], ends[3]), key_between(ends[1], ends[2])),
              face->center(true));
        }
    }

    /// Calls f(node, key, position) for the nodes of all faces on the outline, of subdomain @p p of this rank; for nodes
    /// of several faces more than once.
    template <class F>
    void for_each_outline_node(const mesh::Mesh<dim> &mesh, const unsigned int p, const F &f) const
    {
      for (const auto &cell : dof_handlers[p]->active_cell_iterators())
        for (const unsigned int k : cell->face_indices())
          if (mesh::is_on_outline(cell->face(k)))
            for_each_face_node(*mesh.subdomains[p], cell->face(k), f);
    }

  private:
    static NodeKey key_between(const mesh::GlobalVertex a, const mesh::GlobalVertex b)
    {
      return {{std::min(a, b), std::max(a, b)}};
    }

    std::vector<std::unique_ptr<const Element<dim>>> elements; // of every cell type on this rank
    std::vector<const Element<dim> *>                element_of;
  };
} // namespace slipstick::mechanics
