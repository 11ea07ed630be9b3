#include <slipstick/mechanics/spaces.h>

#include <deal.II/base/mpi.h>
#include <deal.II/base/quadrature_lib.h>
#include <deal.II/fe/fe_q.h>
#include <deal.II/fe/fe_simplex_p.h>
#include <deal.II/fe/mapping_fe.h>
#include <deal.II/fe/mapping_q.h>

#include <algorithm>
#include <cmath>

namespace slipstick::mechanics
{
  namespace
  {
    /// Mapping of simplices of degree 1 or 2 whose edges follow their own manifolds. MappingFE of deal.II 9.4 uses only
    /// the manifold of the cell, which leaves curved boundaries straight, and asserts that the edges have no other
    /// manifold.
    template <int dim>
    class SimplexMapping : public dealii::MappingFE<dim>
    {
    public:
      using dealii::MappingFE<dim>::MappingFE;

      std::unique_ptr<dealii::Mapping<dim>> clone() const override
      {
        return std::make_unique<SimplexMapping<dim>>(*this);
      }

    protected:
      std::vector<dealii::Point<dim>> compute_mapping_support_points(
        const typename dealii::Triangulation<dim>::cell_iterator &cell) const override
      {
        std::vector<dealii::Point<dim>> points;
        for (const unsigned int v : cell->vertex_indices())
          points.push_back(cell->vertex(v));
        if (this->get_degree() == 2)
          for (const unsigned int e : cell->line_indices())
            points.push_back(cell->line(e)->center(true));
        return points;
      }
    };

    /// Mapping of hexahedra of degree 2 whose edges and faces follow their own manifolds; MappingQ uses that of the
    /// cell.
    class HexahedronMapping : public dealii::MappingQ<3>
    {
    public:
      using dealii::MappingQ<3>::MappingQ;

      std::unique_ptr<dealii::Mapping<3>> clone() const override
      {
        return std::make_unique<HexahedronMapping>(*this);
      }

    protected:
      std::vector<dealii::Point<3>> compute_mapping_support_points(
        const dealii::Triangulation<3>::cell_iterator &cell) const override
      {
        std::vector<dealii::Point<3>> points;
        dealii::Point<3>              middle; // on the Coons patch of the faces
        const auto                    add = [&](const dealii::Point<3> &x, const double share) {
          points.push_back(x);
          middle += share * dealii::Tensor<1, 3>(x);
        };
        for (const unsigned int v : cell->vertex_indices())
          add(cell->vertex(v), 0.125);
        for (const unsigned int l : cell->line_indices())
          add(cell->line(l)->center(true), -0.25);
        for (const unsigned int f : cell->face_indices())
          add(cell->face(f)->center(true), 0.5);
        points.push_back(middle);
        return points;
      }
    };

    template <int dim>
    std::unique_ptr<const dealii::FiniteElement<dim>> scalar_element(const dealii::ReferenceCell cell,
                                                                     const unsigned int          degree)
    {
      if (cell.is_simplex())
        return std::make_unique<dealii::FE_SimplexP<dim>>(degree);
      return std::make_unique<dealii::FE_Q<dim>>(degree);
    }

    template <int dim>
    std::unique_ptr<const dealii::Mapping<dim>> isoparametric(const dealii::ReferenceCell cell,
                                                              const unsigned int          degree)
    {
      if constexpr (dim == 3)
        if (!cell.is_simplex() && degree == 2)
          return std::make_unique<HexahedronMapping>(degree);
      if (!cell.is_simplex())
        return std::make_unique<dealii::MappingQ<dim>>(degree);
      return std::make_unique<SimplexMapping<dim>>(dealii::FE_SimplexP<dim>(degree));
    }
    /// Rules with n = 2 in deal.II (of Witherden and Vincent: 4 points in the plane, 6 in space) are not symmetric, so
    /// that results would depend on the order of the corners. Instead: that of order 2 with as many points as corners
    /// (Hammer, Stroud 1956), which is exact for the stiffness of straight elements of degree 2.
    template <int dim>
    dealii::Quadrature<dim> symmetric_rule(const unsigned int n)
    {
      if (n != 2)
        return dealii::QGaussSimplex<dim>(n);
      constexpr unsigned int          n_corners = dim + 1;
      const double                    small     = (1 - 1 / std::sqrt(dim + 2.)) / n_corners;
      std::vector<dealii::Point<dim>> points(n_corners);
      const double                    volume = dim == 2 ? 1. / 2 : 1. / 6;
      for (unsigned int k = 0; k < n_corners; ++k)
        for (unsigned int d = 0; d < dim; ++d)
          points[k][d] = k == d + 1 ? 1 - dim * small : small;
      return dealii::Quadrature<dim>(points, std::vector<double>(n_corners, volume / n_corners));
    }

    template <int dim>
    bool is_curved(const dealii::Triangulation<dim> &triangulation)
    {
      for (const auto id : triangulation.get_manifold_ids())
        if (id != dealii::numbers::flat_manifold_id)
          return true;
      return false;
    }
  } // namespace

  template <int dim>
  Element<dim>::Element(const dealii::ReferenceCell cell_, const unsigned int degree_, const bool is_curved_)
    : cell(cell_)
    , degree(degree_)
    , is_curved(is_curved_)
    , scalar(scalar_element<dim>(cell, degree))
    , vector(std::make_unique<dealii::FESystem<dim>>(*scalar, dim))
    , mapping(isoparametric<dim>(cell, is_curved ? degree : 1))
    , stiffness(cell_quadrature(cell.is_simplex() && (degree == 1 || dim == 3) ? degree : degree + 1))
    , loads(cell_quadrature(degree + 2))
    , stress(cell_quadrature(cell.is_simplex() && degree == 2 && dim == 3 ? 3 : degree))
  {
    AssertThrow(degree == 1 || degree == 2,
                dealii::ExcMessage("nodes of boundaries are identified by two vertices: degree 1 or 2"));
  }

  template <int dim>
  dealii::Quadrature<dim> Element<dim>::cell_quadrature(const unsigned int n) const
  {
    if (cell.is_simplex())
      return symmetric_rule<dim>(n);
    return dealii::QGauss<dim>(n);
  }

  template <int dim>
  dealii::Quadrature<dim - 1> Element<dim>::face_quadrature(const unsigned int n) const
  {
    if constexpr (dim == 3)
      if (cell.is_simplex())
        return symmetric_rule<dim - 1>(n);
    return dealii::QGauss<dim - 1>(n);
  }

  template <int dim>
  void Element<dim>::nodes_of(const typename dealii::DoFHandler<dim>::active_cell_iterator &on,
                              std::vector<dealii::types::global_dof_index>                 &dofs,
                              std::vector<unsigned int>                                    &nodes) const
  {
    dofs.resize(vector->n_dofs_per_cell());
    nodes.resize(n_nodes());
    on->get_dof_indices(dofs);
    for (unsigned int i = 0; i < nodes.size(); ++i)
      nodes[i] = dofs[vector->component_to_system_index(0, i)] / dim;
  }

  template <int dim>
  Spaces<dim>::Spaces(const mesh::Mesh<dim> &mesh, const unsigned int degree_)
    : degree(degree_)
  {
    for (const auto &subdomain : mesh.subdomains)
      {
        const auto &types = subdomain->triangulation.get_reference_cells();
        AssertThrow(types.size() == 1, dealii::ExcMessage("the cells of a subdomain must be of one type"));
        const bool curved = is_curved(subdomain->triangulation);
        auto       found  = std::find_if(elements.begin(), elements.end(), [&](const auto &e) {
          return e->cell == types[0] && e->is_curved == curved;
        });
        if (found == elements.end())
          found = elements.insert(elements.end(), std::make_unique<Element<dim>>(types[0], degree, curved));
        element_of.push_back(found->get());
        dof_handlers.push_back(std::make_unique<dealii::DoFHandler<dim>>(subdomain->triangulation));
        dof_handlers.back()->distribute_dofs(*element_of.back()->vector);
        n_dofs += dof_handlers.back()->n_dofs();
      }
    n_dofs = dealii::Utilities::MPI::sum(n_dofs, mesh.comm);
  }

  template <int dim>
  dealii::Quadrature<dim> Element<dim>::stiffness_rule(const mesh::Kinematics<dim> &kinematics) const
  {
    if (kinematics.is_revolution() && cell.is_simplex() && degree == 1)
      return cell_quadrature(2);
    return stiffness;
  }

  template struct Element<2>;
  template struct Element<3>;
  template struct Spaces<2>;
  template struct Spaces<3>;
} // namespace slipstick::mechanics
