// Which of many sparse rows are linear combinations of others.
#pragma once

#include <map>
#include <vector>

namespace slipstick::interface
{
  /// Sparse rows by Gaussian elimination, one after another. Fill stays small if every row has a pivot of its own that
  /// few other rows contain; callers say where to look for it.
  class Echelon
  {
  public:
    using Vector = std::map<unsigned int, double>; // by column

    /// The remainder of @p row after elimination of the rows so far: zero (up to rounding) if they imply it.
    Vector reduce(Vector row) const;

    /// Adds a row unless the others imply it (largest entry left is no more than @p tolerance). The pivot is sought in
    /// columns [first, last) and taken elsewhere only if it would be less than a tenth of the largest entry.
    /// @return whether it was added.
    bool add(const Vector &row, const double tolerance, const unsigned int first, const unsigned int last);

  private:
    std::vector<Vector>                  rows;   // pivot 1, zero at the pivots of the rows before
    std::vector<unsigned int>            pivot;  // of the rows
    std::map<unsigned int, unsigned int> row_of; // by pivot
  };
} // namespace slipstick::interface
