// Detection of linearly dependent sparse rows.
#pragma once

#include <map>
#include <vector>

namespace slipstick::interface
{
  /// Gaussian elimination of sparse rows, one at a time. Fill stays small if every row has a pivot that few other rows
  /// contain; callers specify where to search for it.
  class Echelon
  {
  public:
    using Vector = std::map<unsigned int, double>; // by column

    /// The remainder of @p row after elimination of the rows so far: zero (up to rounding) if it depends on them.
    Vector reduce(Vector row) const;

    /// Adds a row unless it depends on the others (largest remaining entry at most @p tolerance). The pivot is taken
    /// from columns [first, last) unless it would be less than a tenth of the largest entry.
    /// @return whether it was added.
    bool add(const Vector &row, const double tolerance, const unsigned int first, const unsigned int last);

  private:
    std::vector<Vector>                  rows;   // pivot 1, zero at the pivots of previous rows
    std::vector<unsigned int>            pivot;  // of the rows
    std::map<unsigned int, unsigned int> row_of; // by pivot
  };
} // namespace slipstick::interface
