// FEValues that are computed once for cells that are translations of each other.
#pragma once

#include <deal.II/fe/fe_values.h>

namespace slipstick::fem
{
  /// Gradients and JxW of the scalar element on one cell after the other. Straight-sided cells whose vertices agree up
  /// to a translation share them (deal.II's own detection works with an absolute length, which small units defeat).
  template <int dim>
  class CellValues
  {
  public:
    using Cell = typename dealii::Triangulation<dim>::cell_iterator;

    CellValues(const dealii::Mapping<dim>       &mapping,
               const dealii::FiniteElement<dim> &element,
               const dealii::Quadrature<dim>    &quadrature)
      : values(mapping, element, quadrature, dealii::update_gradients | dealii::update_JxW_values)
    {}

    /// @return whether the values changed.
    bool reinit(const Cell &cell)
    {
      if (previous.state() == dealii::IteratorState::valid && values.get_fe().degree == 1 &&
          is_translation(cell, previous))
        return false;
      values.reinit(cell);
      previous = cell;
      return true;
    }

    const dealii::FEValues<dim> &operator*() const
    {
      return values;
    }

  private:
    static bool is_translation(const Cell &a, const Cell &b)
    {
      constexpr double tolerance = 1e-11; // part of the diameter by which vertices may differ
      const double     length    = tolerance * a->diameter();
      for (const unsigned int v : a->vertex_indices())
        if (((a->vertex(v) - a->vertex(0)) - (b->vertex(v) - b->vertex(0))).norm() > length)
          return false;
      return true;
    }

    dealii::FEValues<dim> values;
    Cell                  previous;
  };
} // namespace slipstick::fem
