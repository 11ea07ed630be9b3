// Multipliers on parts of a slave surface that are held by supports.
#pragma once

#include <slipstick/interface/mortar_row.h>
#include <slipstick/mechanics/surface_facet.h>
#include <slipstick/mesh/mesh.h>

namespace slipstick::interface
{
  /// Whether prescribed components hold a direction. @p Components one entry a component, true if it is prescribed.
  template <int dim, class Components>
  bool are_held(const Components &components, const dealii::Tensor<1, dim> &direction)
  {
    constexpr double held    = 1e-6; // the part in free directions is below this
    double           squares = 0;
    for (unsigned int c = 0; c < dim; ++c)
      squares += components[c] ? 0. : direction[c] * direction[c];
    return squares <= held * held;
  }

  /// Removes the rows of slave nodes that supports hold along their normal and adds them to the nearest nodes on the
  /// same edges or facets that are not held. Such a row contains displacements of the master only. If the slave mesh is
  /// finer, there are more of these rows than master nodes in them: the forces on them are not unique, and if all are
  /// closed or stick their gaps contradict each other. If it is coarser, and the master is held at the same place, the
  /// row ties its next nodes to each other, with forces far above the loads. The sum of the test functions remains 1, so that equal pressures are
  /// still a uniform pressure (as at cross points: Wohlmuth 2000, section 1.2; Puso, Laursen 2004, section 4.3). A row
  /// with one master node, or without such a neighbour, is kept.
  /// @param all boundary edges or faces of all bodies. @param slave those of the slave side.
  template <int dim>
  void give_held_rows_to_neighbours(const scene::Scene<dim>                         &scene,
                                    const mesh::Mesh<dim>                           &mesh,
                                    const std::vector<mechanics::BoundaryPart<dim>> &all,
                                    const std::vector<mechanics::BoundaryPart<dim>> &slave,
                                    std::vector<MortarRow<dim>>                     &rows);
} // namespace slipstick::interface
