// Sets of numbers that are joined step by step (union-find).
#pragma once

#include <algorithm>
#include <numeric>
#include <vector>

namespace slipstick
{
  /// The numbers 0 .. n - 1, at first each in a set of its own.
  class DisjointSets
  {
  public:
    explicit DisjointSets(const std::size_t n)
      : parent(n)
    {
      std::iota(parent.begin(), parent.end(), 0);
    }

    /// The smallest number of the set of @p i.
    unsigned int root(unsigned int i)
    {
      while (parent[i] != i)
        i = parent[i] = parent[parent[i]];
      return i;
    }

    void join(const unsigned int a, const unsigned int b)
    {
      const unsigned int root_a = root(a), root_b = root(b);
      parent[std::max(root_a, root_b)] = std::min(root_a, root_b);
    }

  private:
    std::vector<unsigned int> parent;
  };
} // namespace slipstick
