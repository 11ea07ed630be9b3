// The point of a cell that is nearest to a given point.
#pragma once

#include <slipstick/mechanics/spaces.h>

#include <optional>

namespace slipstick::mechanics
{
  template <int dim>
  struct PointOfCell
  {
    dealii::Point<dim> unit;         // in the reference cell
    double             distance = 0; // from the given point [mm]
  };

  /// The point of @p cell nearest to @p x, approximately; nothing if x is farther from the bounding box of the cell
  /// than a fifth of its diameter, or too far outside a distorted cell.
  template <int dim>
  std::optional<PointOfCell<dim>> nearest_in_cell(const Element<dim>                                           &element,
                                                  const typename dealii::DoFHandler<dim>::active_cell_iterator &cell,
                                                  const dealii::Point<dim>                                     &x);
} // namespace slipstick::mechanics
