// Subdomains whose products are computed together.
#pragma once

#include <unordered_map>
#include <vector>

namespace slipstick::tfeti
{
  /// Columns solved at once: a factor is read from memory once for all of them, and they stay in the cache.
  constexpr unsigned int largest_batch = 16;

  /// The numbers 0 .. n - 1 in groups of the same @p identity (a pointer), ordered by their first members, of at most
  /// largest_batch numbers; numbers whose identity is null are not grouped.
  template <typename Identity>
  std::vector<std::vector<unsigned int>> batches(const unsigned int n, const Identity &identity)
  {
    std::vector<std::vector<unsigned int>>        result;
    std::unordered_map<const void *, std::size_t> open;
    for (unsigned int p = 0; p < n; ++p)
      {
        const void *const id    = identity(p);
        const auto        found = open.find(id);
        if (id && found != open.end() && result[found->second].size() < largest_batch)
          {
            result[found->second].push_back(p);
            continue;
          }
        open[id] = result.size();
        result.push_back({p});
      }
    return result;
  }
} // namespace slipstick::tfeti
