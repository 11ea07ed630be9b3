#include <slipstick/qp/box.h>
#include <slipstick/tfeti/row_metric.h>

#include <deal.II/base/mpi.h>

#include <algorithm>
#include <cmath>

namespace slipstick::tfeti
{
  namespace
  {
    // Residuals are projected twice when stiffnesses of rows differ by more than this factor.
    constexpr double large_stiffness_ratio = 1e3;
  } // namespace

  RowMetric::RowMetric(std::vector<double> stiffnesses, const Constraints &rows, const MPI_Comm comm)
    : relative(std::move(stiffnesses))
  {
    if (dealii::Utilities::MPI::max(rows.compliance.empty() ? 0 : 1, comm) > 0)
      roots.assign(relative.size(), 1.);
    for (unsigned int r = 0; r < rows.compliance.size(); ++r)
      {
        const double part = 1 / (1 + rows.compliance[r] * relative[r]);
        relative[r] *= part;
        roots[r] = std::sqrt(part);
      }
    smallest =
      dealii::Utilities::MPI::min(relative.empty() ? qp::infinity : *std::min_element(relative.begin(), relative.end()),
                                  comm);
    for (double &stiffness : relative)
      stiffness /= smallest;
    for (const auto &point : rows.contact_points) // equal stiffness of both tangents of a node: discs stay round
      if (point.tangential_row != invalid_row && point.second_row != invalid_row)
        relative[point.tangential_row] = relative[point.second_row] =
          std::sqrt(relative[point.tangential_row] * relative[point.second_row]);
    const double largest = relative.empty() ? 1. : *std::max_element(relative.begin(), relative.end());
    differs_much         = dealii::Utilities::MPI::max(largest, comm) > large_stiffness_ratio;
  }

  InputError stiffnesses_too_far_apart()
  {
    return InputError("the stiffnesses of the bodies differ by more than double precision can tell",
                      "check their thicknesses, moduli and sizes for wrong units");
  }
} // namespace slipstick::tfeti
