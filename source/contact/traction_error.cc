#include <slipstick/contact/traction_error.h>
#include <slipstick/qp/direction_store.h>

#include <deal.II/base/mpi.h>

#include <algorithm>
#include <cmath>

namespace slipstick::contact
{
  namespace
  {
    // Admissible error of the tractions of a pair: this times the tolerance of the solver (1 % at 1e-4) ...
    constexpr double traction_error = 100;
    // ... and at most this.
    constexpr double largest_traction_error = 0.05;
    // Lower limits of the reference traction of a pair: this part of the largest traction of any pair, ...
    constexpr double negligible_pair = 1e-3;
    // ... this part of the largest in any earlier step, so that the admissible error is at least the tolerance times
    // that, ...
    constexpr double negligible_remainder = 1 / traction_error;
    // ... and this part of the forces that balance the loads, on one contact node, for pairs without load.
    constexpr double negligible_force = 1e-6;
  } // namespace

  TractionError::TractionError(const tfeti::DualProblem &dual,
                               const double              tolerance,
                               const double              balance,
                               const double              largest_before)
    : dual(dual)
    , part(std::min(largest_traction_error, traction_error * tolerance))
    , balance(balance)
    , largest_before(largest_before)
  {}

  bool TractionError::is_small(const Vector &x, const Vector &error) const
  {
    const auto squares = squares_of_pairs(x, error);
    double     largest = 0;
    for (std::size_t k = 0; k < squares.size(); k += 2)
      largest = std::max(largest, squares[k]);
    double area = 0;
    for (const auto &point : dual.constraints().contact_points)
      area = std::max(area, point.traction_area);
    area               = dealii::Utilities::MPI::max(area, dual.communicator());
    const double none  = area > 0 ? negligible_force * balance / std::sqrt(area) : 0.;
    const double least = std::max({negligible_pair * std::sqrt(largest), negligible_remainder * largest_before, none});
    for (std::size_t k = 0; k < squares.size(); k += 2)
      if (squares[k + 1] > part * part * std::max(squares[k], least * least))
        return false;
    return true;
  }

  double TractionError::largest(const Vector &x) const
  {
    double result = largest_before;
    for (const double square : squares_of_pairs(x, dual.zero()))
      result = std::max(result, std::sqrt(square));
    return result;
  }

  // For each pair: squared L2 norms of the tractions of x and of the error [N MPa].
  std::vector<double> TractionError::squares_of_pairs(const Vector &x, const Vector &error) const
  {
    unsigned int n_pairs = 0;
    for (const auto &point : dual.constraints().contact_points)
      n_pairs = std::max(n_pairs, point.pair + 1);
    std::vector<double> squares(2 * dealii::Utilities::MPI::max(n_pairs, dual.communicator()), 0.);
    for (const auto &point : dual.constraints().contact_points)
      for (const unsigned int row : {point.normal_row, point.tangential_row, point.second_row})
        if (row != tfeti::invalid_row)
          {
            squares[2 * point.pair] += x.local_element(row) * x.local_element(row) / point.traction_area;
            squares[2 * point.pair + 1] += error.local_element(row) * error.local_element(row) / point.traction_area;
          }
    qp::sum_all(squares, dual.reduction());
    return squares;
  }
} // namespace slipstick::contact
