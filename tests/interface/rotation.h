// Rows must resist no rigid motion of both sides.
#pragma once

#include <slipstick/interface/gap_rotation.h>

#include <gtest/gtest.h>

#include <map>

namespace slipstick::test
{
  /// Moments of @p force at @p place about the origin, one in the plane, three in space.
  template <int dim>
  std::array<double, 3> moment(const dealii::Tensor<1, dim> &place, const dealii::Tensor<1, dim> &force)
  {
    std::array<double, 3> result{{0, 0, place[0] * force[1] - place[1] * force[0]}};
    if constexpr (dim == 3)
      {
        result[0] = place[1] * force[2] - place[2] * force[1];
        result[1] = place[2] * force[0] - place[0] * force[2];
      }
    return result;
  }

  /// Finds rotation weights; the coefficients of every row along each axis must have neither sum nor moment.
  /// @param is_apart whether every row must have rotation weights
  template <int dim>
  void expect_no_resistance_to_rotations(std::vector<interface::MortarRow<dim>>           rows,
                                         const std::vector<mechanics::BoundaryPart<dim>> &slave,
                                         const std::vector<mechanics::BoundaryPart<dim>> &master,
                                         const bool                                       is_apart)
  {
    using Tensor = dealii::Tensor<1, dim>;
    std::map<mechanics::NodeKey, dealii::Point<dim>> at;
    for (const auto *side : {&slave, &master})
      for (const auto &part : *side)
        for (unsigned int i = 0; i < part.n_nodes; ++i)
          at[part.keys[i]] = part.node(i);
    interface::find_rotation_weights<dim>(slave, master, true, rows);
    ASSERT_FALSE(rows.empty());
    for (const auto &row : rows)
      for (unsigned int d = 0; d < dim; ++d)
        {
          Tensor direction, sum;
          direction[d] = 1;
          std::array<double, 3> moments{};
          const auto            add = [&](const Tensor &place, const Tensor &coefficient) {
            sum += coefficient;
            const auto part = moment<dim>(place, coefficient);
            for (unsigned int k = 0; k < 3; ++k)
              moments[k] += part[k];
          };
          for (const auto &[key, weight] : row.slave_weights)
            add(at.at(key), weight * direction);
          for (const auto &[key, weight] : row.master_weights)
            add(at.at(key), -weight * direction);
          const auto spans = interface::spans_of_carriers<dim>(row.apart, row.normal);
          for (unsigned int k = 0; k < interface::n_carriers; ++k)
            {
              const auto &of_side = row.rotation_weights[k];
              EXPECT_TRUE(!is_apart || k == 2 || !of_side.empty()); // the lateral offset may be 0
              std::vector<double> weights;
              std::vector<Tensor> positions;
              for (const auto &[key, weight] : of_side)
                {
                  weights.push_back(weight);
                  positions.push_back(at.at(key));
                }
              const auto coefficients = interface::rotation_coefficients(weights, positions, spans[k], direction);
              for (unsigned int j = 0; j < coefficients.size(); ++j)
                {
                  add(positions[j], -1. * coefficients[j]);
                  EXPECT_LT(coefficients[j].norm(), 1.); // less than the row itself
                }
            }
          EXPECT_LT(sum.norm(), 1e-13);
          for (const double of_axis : moments)
            EXPECT_NEAR(of_axis, 0, 1e-12);
        }
  }
} // namespace slipstick::test
