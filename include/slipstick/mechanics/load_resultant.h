// Resultants of loads, and the accuracy of their integration.
#pragma once

#include <slipstick/base/resultant.h>

#include <deal.II/base/point.h>

#include <array>
#include <optional>

namespace slipstick::mechanics
{
  /// Resultant of one load of the scene.
  struct LoadResultant
  {
    Resultant                            sum;
    std::optional<std::array<double, 3>> unresolved; // where the formula is too rough for the mesh or not
                                                     // integrable: body forces, and tractions on solids, if two
                                                     // quadratures differ by one percent
  };

  /// Missing components are 0.
  template <int dim>
  std::array<double, 3> in_space(const dealii::Point<dim> &x)
  {
    std::array<double, 3> all{{0, 0, 0}};
    for (unsigned int d = 0; d < dim; ++d)
      all[d] = x[d];
    return all;
  }

  /// Difference between two quadratures of a load.
  struct QuadratureDifference
  {
    double                size = 0, difference = 0; // sums of magnitudes over cells or faces [N]
    double                largest = -1;             // difference in one cell or face
    std::array<double, 3> at{{0, 0, 0}};            // its place

    void add(const double size_, const double difference_, const std::array<double, 3> &place)
    {
      add({size_, difference_, difference_, place});
    }

    void add(const QuadratureDifference &other)
    {
      size += other.size;
      difference += other.difference;
      if (other.largest > largest)
        {
          largest = other.largest;
          at      = other.at;
        }
    }
  };
} // namespace slipstick::mechanics
