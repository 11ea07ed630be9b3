#include <slipstick/contact/traction_error.h>
#include <slipstick/qp/kernels.h>

#include <deal.II/base/mpi.h>

#include <algorithm>
#include <cmath>

namespace slipstick::contact
{
  namespace
  {
    // Admissible error of the tractions of a pair: this times the tolerance of the solver (0.5 % at 1e-4) ...
    constexpr double traction_error = 50;
    // ... and at most this.
    constexpr double largest_traction_error = 0.05;
    // Lower limits of the reference of an error: this fraction of all tractions of the pair, ...
    constexpr double negligible_component = 1e-2;
    // ... this fraction of the largest tractions of any pair, ...
    constexpr double negligible_pair = 1e-6;
    // ... this fraction of the largest in any earlier step, so that the admissible error is at least the tolerance
    // times that, ...
    constexpr double negligible_remainder = 1 / traction_error;
    // ... and this fraction of the forces that balance the loads, on one contact node, for pairs without load.
    constexpr double negligible_force = 1e-6;

    /// Of contact nodes and bonded ones. Collective.
    double largest_area_of_nodes(const tfeti::DualProblem &dual)
    {
      const tfeti::Constraints &rows = dual.constraints();
      double                    area = 0;
      for (const auto *points : {&rows.contact_points, &rows.bonded_points})
        for (const auto &point : *points)
          area = std::max(area, point.traction_area);
      return dealii::Utilities::MPI::max(area, dual.communicator());
    }

    double norm(const PairTractions &pair)
    {
      return std::hypot(pair.pressure, pair.tangential);
    }
  } // namespace

  TractionErrors::TractionErrors(const tfeti::DualProblem &dual, const Vector &x, const Vector &error)
  {
    const tfeti::Constraints &rows    = dual.constraints();
    unsigned int              n_pairs = 0;
    for (const auto *points : {&rows.contact_points, &rows.bonded_points})
      for (const auto &point : *points)
        n_pairs = std::max(n_pairs, point.pair + 1);
    n_pairs = dealii::Utilities::MPI::max(n_pairs, dual.communicator());
    std::vector<double> squares(4 * n_pairs, 0.);
    for (const auto *points : {&rows.contact_points, &rows.bonded_points})
      for (const auto &point : *points)
        for (const unsigned int row : {point.normal_row, point.tangential_row, point.second_row})
          if (row != tfeti::invalid_row)
            {
              double *of_pair = &squares[4 * point.pair + (row == point.normal_row ? 0 : 2)];
              of_pair[0] += x.local_element(row) * x.local_element(row) / point.traction_area;
              of_pair[1] += error.local_element(row) * error.local_element(row) / point.traction_area;
            }
    qp::sum_all(squares, dual.reduction());
    for (std::size_t k = 0; k < squares.size(); k += 4)
      {
        norms.push_back({std::sqrt(squares[k]), std::sqrt(squares[k + 2])});
        errors.push_back({std::sqrt(squares[k + 1]), std::sqrt(squares[k + 3])});
      }
  }

  double TractionErrors::largest_norm() const
  {
    double result = 0;
    for (const auto &pair : norms)
      result = std::max(result, norm(pair));
    return result;
  }

  std::vector<PairTractions> TractionErrors::relative(const double least) const
  {
    const double               of_all = std::max(negligible_pair * largest_norm(), least);
    std::vector<PairTractions> result;
    for (std::size_t k = 0; k < norms.size(); ++k)
      {
        const double least_of_pair = std::max(negligible_component * norm(norms[k]), of_all);
        const auto   over          = [least_of_pair](const double error, const double of) {
          return error == 0 ? 0. : error / std::max(of, least_of_pair);
        };
        result.push_back(
          {over(errors[k].pressure, norms[k].pressure), over(errors[k].tangential, norms[k].tangential)});
      }
    return result;
  }

  TractionTest::TractionTest(const tfeti::DualProblem &dual_,
                             const double              tolerance,
                             const double              balance_,
                             const double              largest_before_)
    : dual(dual_)
    , part(std::min(largest_traction_error, traction_error * tolerance))
    , balance(balance_)
    , largest_area(largest_area_of_nodes(dual_))
    , largest_before(largest_before_)
  {}

  bool TractionTest::accepts(const Vector &x, const Vector &error) const
  {
    const double none  = has_pairs() ? negligible_force * balance / std::sqrt(largest_area) : 0.;
    const auto   pairs = TractionErrors(dual, x, error).relative(std::max(negligible_remainder * largest_before, none));
    return std::all_of(pairs.begin(), pairs.end(), [this](const PairTractions &pair) {
      return pair.pressure <= part && pair.tangential <= part;
    });
  }

  double TractionTest::largest(const Vector &x) const
  {
    return std::max(largest_before, TractionErrors(dual, x, dual.zero()).largest_norm());
  }
} // namespace slipstick::contact
