// Stiffnesses of the rows of B, used as weights in projections and norms of the dual problem.
#pragma once

#include <slipstick/base/exceptions.h>
#include <slipstick/tfeti/constraints.h>

#include <mpi.h>

#include <vector>

namespace slipstick::tfeti
{
  /// The stiffness of a row is the force that opens it by 1 mm with the other rows held, with its own compliance in
  /// series.
  class RowMetric
  {
  public:
    /// No weights: all rows have the same stiffness.
    RowMetric() = default;

    /// @param stiffnesses of the owned rows without their own compliance [N/mm]. Collective.
    RowMetric(std::vector<double> stiffnesses, const Constraints &rows, const MPI_Comm comm);

    /// Stiffnesses of the owned rows over the least one of all ranks; the same for both tangents of a node. Empty: all
    /// equal.
    const std::vector<double> &weights() const
    {
      return relative;
    }

    /// The least stiffness [N/mm].
    double least() const
    {
      return smallest;
    }

    /// Of the owned rows: square root of the ratio of the stiffness with the row's compliance to that without. Empty:
    /// 1.
    const std::vector<double> &compliance_factors() const
    {
      return roots;
    }

    /// Whether the stiffnesses differ so much that the rounding of one projection would be visible in the stiffest
    /// rows.
    bool is_wide() const
    {
      return differs_much;
    }

  private:
    std::vector<double> relative, roots;
    double              smallest     = 1;
    bool                differs_much = false;
  };

  /// The error of scenes whose projections with these weights are singular in double precision.
  InputError stiffnesses_too_far_apart();
} // namespace slipstick::tfeti
