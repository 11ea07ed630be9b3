// FEValues computed once for cells that are translations of each other.
#pragma once

#include <deal.II/fe/fe_values.h>

#include <optional>

namespace slipstick::mechanics
{
  /// Gradients, JxW and other requested values of the scalar element, cell by cell. Straight-sided cells whose vertices
  /// agree up to a translation share them (deal.II's own detection uses an absolute length, which fails for small
  /// units).
  template <int dim>
  class CellValues
  {
  public:
    using Cell = typename dealii::Triangulation<dim>::cell_iterator;

    CellValues(const dealii::Mapping<dim>       &mapping,
               const dealii::FiniteElement<dim> &element,
               const dealii::Quadrature<dim>    &quadrature,
               const dealii::UpdateFlags         more = dealii::update_default)
      : values(mapping, element, quadrature, dealii::update_gradients | dealii::update_JxW_values | more)
    {}

    /// @return whether the values changed.
    bool reinit(const Cell &cell)
    {
      if (!is_straight)
        is_straight = values.get_fe().degree == 1 || is_flat(cell->get_triangulation());
      if (previous.state() == dealii::IteratorState::valid && *is_straight && is_translation(cell, previous))
        {
          shift = cell->vertex(0) - previous->vertex(0);
          return false;
        }
      values.reinit(cell);
      previous = cell;
      shift    = dealii::Tensor<1, dim>();
      return true;
    }

    /// The values; the quadrature points in them are those of the cell for which they were computed.
    const dealii::FEValues<dim> &operator*() const
    {
      return values;
    }

    /// Point q on the cell of the last reinit(); needs update_quadrature_points.
    dealii::Point<dim> point(const unsigned int q) const
    {
      return values.quadrature_point(q) + shift;
    }

  private:
    static bool is_flat(const dealii::Triangulation<dim> &triangulation)
    {
      for (const auto id : triangulation.get_manifold_ids())
        if (id != dealii::numbers::flat_manifold_id)
          return false;
      return true;
    }

    static bool is_translation(const Cell &a, const Cell &b)
    {
      constexpr double   tolerance  = 1e-11; // difference of vertices relative to the cell's size
      const unsigned int n_vertices = a->n_vertices();
      const double       square     = tolerance * tolerance * a->vertex(0).distance_square(a->vertex(n_vertices - 1));
      for (unsigned int v = 1; v < n_vertices; ++v)
        if (((a->vertex(v) - a->vertex(0)) - (b->vertex(v) - b->vertex(0))).norm_square() > square)
          return false;
      return true;
    }

    dealii::FEValues<dim>  values;
    Cell                   previous;
    dealii::Tensor<1, dim> shift;
    std::optional<bool>    is_straight;
  };
} // namespace slipstick::mechanics
