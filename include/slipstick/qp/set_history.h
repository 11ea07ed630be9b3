// History of the active sets of a method, compared over all processes.
#pragma once

#include <slipstick/qp/friction_discs.h>
#include <slipstick/qp/kernels.h>

#include <algorithm>
#include <deque>
#include <limits>
#include <utility>
#include <vector>

namespace slipstick::qp::detail
{
  /// The latest sets, each with a residual.
  class SetHistory
  {
  public:
    /// @param most_ largest number of sets that are kept.
    explicit SetHistory(const std::size_t most_)
      : most(most_)
    {}

    void add(Sides sides, const double residual = 0)
    {
      sets.push_back({std::move(sides), residual});
      if (sets.size() > most)
        sets.pop_front();
    }

    void clear()
    {
      sets.clear();
    }

    std::size_t size() const
    {
      return sets.size();
    }

    template <typename Reduction>
    bool contains(const Sides &sides, const Reduction &reduction) const
    {
      const auto equal = equal_to(sides, reduction);
      return std::find(equal.begin(), equal.end(), true) != equal.end();
    }

    /// The smallest residual of this set, if it occurred before but not last; otherwise infinity.
    template <typename Reduction>
    double least_of_earlier(const Sides &sides, const Reduction &reduction) const
    {
      const auto equal = equal_to(sides, reduction);
      double     found = std::numeric_limits<double>::infinity();
      if (!equal.empty() && !equal.back())
        for (std::size_t i = 0; i < sets.size(); ++i)
          if (equal[i])
            found = std::min(found, sets[i].residual);
      return found;
    }

  private:
    struct Met
    {
      Sides  sides;
      double residual;
    };

    // Which of the sets are equal to this one on all processes.
    template <typename Reduction>
    std::vector<bool> equal_to(const Sides &sides, const Reduction &reduction) const
    {
      std::vector<double> differs;
      for (const Met &set : sets)
        differs.push_back(set.sides == sides ? 0. : 1.);
      sum_all(differs, reduction);
      std::vector<bool> result;
      for (const double n : differs)
        result.push_back(n == 0);
      return result;
    }

    std::size_t     most;
    std::deque<Met> sets;
  };
} // namespace slipstick::qp::detail
