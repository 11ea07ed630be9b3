// Rotation of both sides of a contact row across its gap.
//
// Where the points of a row are apart by r (slave minus master), a rotation omega of both bodies as a whole makes them
// move by omega x r relative to each other. Rows subtract it, with the rotations of both sides around their points, so
// that they resist no rigid motion and their forces have no moment.
//
// Where a gap closes between two bodies, their points meet: the distance is zero then, each body is in equilibrium in its
// own frame, and the rows that are solved with follow no rotation across it (doc/decisions/0158). Only motions that
// nothing holds are found with rows that do.
#pragma once

#include <slipstick/interface/mortar_row.h>
#include <slipstick/mechanics/surface_facet.h>

#include <vector>

namespace slipstick::interface
{
  /// The parts of the vector @p apart from the master point to the slave point, by what carries them: slave and master
  /// half of the gap along the normal each, so that sides can be exchanged, and the master the rest, a lateral offset of
  /// the means, so that normal forces on a round slave pass through its centre.
  template <int dim>
  std::array<dealii::Tensor<1, dim>, n_carriers> spans_of_carriers(const dealii::Tensor<1, dim> &apart,
                                                                   const dealii::Tensor<1, dim> &normal)
  {
    const dealii::Tensor<1, dim> half = 0.5 * (apart * normal) * normal;
    return {{half, half, apart - 2. * half}};
  }

  /// Sets the rotation weights of the rows whose points are apart: those of the nodes around the point of each side, up
  /// to twice the span, or twice the size of the adjacent cells if that is larger. They decrease smoothly to zero there,
  /// so that they do not depend on the orientation of the scene.
  /// @param gaps_rotate whether the gap along the normal follows rotations; the lateral part of r always does
  template <int dim>
  void find_rotation_weights(const std::vector<mechanics::BoundaryPart<dim>> &slave,
                             const std::vector<mechanics::BoundaryPart<dim>> &master,
                             const bool                                       gaps_rotate,
                             std::vector<MortarRow<dim>>                     &rows);

  /// The parts of the vector apart that follow rotations: of the slave, and of the master.
  template <int dim>
  std::array<dealii::Tensor<1, dim>, 2> carried_spans(const MortarRow<dim> &row)
  {
    const auto                            spans = spans_of_carriers<dim>(row.apart, row.normal);
    std::array<dealii::Tensor<1, dim>, 2> result;
    for (unsigned int k = 0; k < n_carriers; ++k)
      if (!row.rotation_weights[k].empty())
        result[k == 0 ? 0 : 1] += spans[k];
    return result;
  }

  /// Coefficients a_j with sum_j a_j . u_j = direction . (omega x apart): omega is the rotation that fits the
  /// displacements u_j at the positions best, by weighted least squares; zero about an axis on which all of them lie.
  /// Empty if no rotation moves the points along the direction.
  /// @param weights, positions [mm] of the nodes. @param apart slave point minus master point [mm].
  template <int dim>
  std::vector<dealii::Tensor<1, dim>> rotation_coefficients(const std::vector<double>                 &weights,
                                                            const std::vector<dealii::Tensor<1, dim>> &positions,
                                                            const dealii::Tensor<1, dim>              &apart,
                                                            const dealii::Tensor<1, dim>              &direction);
} // namespace slipstick::interface
