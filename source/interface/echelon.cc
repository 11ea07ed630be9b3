#include <slipstick/interface/echelon.h>

#include <algorithm>
#include <cmath>
#include <set>

namespace slipstick::interface
{
  namespace
  {
    constexpr double small_pivot = 0.1;   // of the largest entry
    constexpr double rounding    = 1e-14; // of the largest entry of the row that is reduced

    double largest(const Echelon::Vector &v, const unsigned int first = 0, const unsigned int last = -1)
    {
      double size = 0;
      for (auto at = v.lower_bound(first); at != v.end() && at->first < last; ++at)
        size = std::max(size, std::abs(at->second));
      return size;
    }
  } // namespace

  Echelon::Vector Echelon::reduce(Vector row) const
  {
    const double           none = rounding * largest(row);
    std::set<unsigned int> todo; // rows whose pivots occur in the row; each adds only pivots of later rows
    for (const auto &[column, value] : row)
      if (const auto found = row_of.find(column); found != row_of.end())
        todo.insert(found->second);
    while (!todo.empty())
      {
        const unsigned int k = *todo.begin();
        todo.erase(todo.begin());
        const double factor = row[pivot[k]];
        for (const auto &[column, value] : rows[k])
          {
            row[column] -= factor * value;
            if (const auto found = row_of.find(column); found != row_of.end() && found->second > k)
              todo.insert(found->second);
          }
        row.erase(pivot[k]);
      }
    for (auto at = row.begin(); at != row.end();)
      at = std::abs(at->second) <= none ? row.erase(at) : std::next(at);
    return row;
  }

  bool Echelon::add(const Vector &row, const double tolerance, const unsigned int first, const unsigned int last)
  {
    Vector       left = reduce(row);
    const double size = largest(left);
    if (!(size > tolerance))
      return false;
    double wanted = largest(left, first, last);
    if (wanted < small_pivot * size)
      wanted = size;
    auto at = left.begin();
    while (std::abs(at->second) != wanted || (wanted != size && (at->first < first || at->first >= last)))
      ++at;
    const unsigned int column = at->first;
    const double       value  = at->second;
    for (auto &[c, v] : left)
      v /= value;
    row_of[column] = rows.size();
    pivot.push_back(column);
    rows.push_back(std::move(left));
    return true;
  }
} // namespace slipstick::interface
