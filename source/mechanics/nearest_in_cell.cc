#include <slipstick/mechanics/nearest_in_cell.h>

#include <algorithm>
#include <limits>

namespace slipstick::mechanics
{
  namespace
  {
    // Cells are examined if their box, enlarged by this fraction of their diameter, contains the point.
    constexpr double margin_of_boxes = 0.2;

    /// Approximately the point of the reference cell nearest to x.
    template <int dim>
    dealii::Point<dim> into_cell(const dealii::ReferenceCell &cell, dealii::Point<dim> x)
    {
      for (unsigned int d = 0; d < dim; ++d)
        x[d] = std::min(1., std::max(0., x[d]));
      if (cell.is_simplex())
        {
          double sum = 0;
          for (unsigned int d = 0; d < dim; ++d)
            sum += x[d];
          if (sum > 1)
            for (unsigned int d = 0; d < dim; ++d)
              x[d] = std::max(0., x[d] - (sum - 1) / dim);
          sum = 0;
          for (unsigned int d = 0; d < dim; ++d)
            sum += x[d];
          if (sum > 1)
            x /= sum;
        }
      return x;
    }

    template <int dim>
    bool may_contain(const typename dealii::DoFHandler<dim>::active_cell_iterator &cell, const dealii::Point<dim> &x)
    {
      const double margin = margin_of_boxes * cell->diameter();
      for (unsigned int d = 0; d < dim; ++d)
        {
          double low = std::numeric_limits<double>::max(), high = -low;
          for (const unsigned int v : cell->vertex_indices())
            {
              low  = std::min(low, cell->vertex(v)[d]);
              high = std::max(high, cell->vertex(v)[d]);
            }
          if (x[d] < low - margin || x[d] > high + margin)
            return false;
        }
      return true;
    }
  } // namespace

  template <int dim>
  std::optional<PointOfCell<dim>> nearest_in_cell(const Element<dim>                                           &element,
                                                  const typename dealii::DoFHandler<dim>::active_cell_iterator &cell,
                                                  const dealii::Point<dim>                                     &x)
  {
    if (!may_contain<dim>(cell, x))
      return {};
    try
      {
        const auto unit = into_cell(element.cell, element.mapping->transform_real_to_unit_cell(cell, x));
        return PointOfCell<dim>{unit, element.mapping->transform_unit_to_real_cell(cell, unit).distance(x)};
      }
    catch (const typename dealii::Mapping<dim>::ExcTransformationFailed &)
      {
        return {};
      }
  }

  template std::optional<PointOfCell<2>> nearest_in_cell(const Element<2> &,
                                                         const dealii::DoFHandler<2>::active_cell_iterator &,
                                                         const dealii::Point<2> &);
  template std::optional<PointOfCell<3>> nearest_in_cell(const Element<3> &,
                                                         const dealii::DoFHandler<3>::active_cell_iterator &,
                                                         const dealii::Point<3> &);
} // namespace slipstick::mechanics
