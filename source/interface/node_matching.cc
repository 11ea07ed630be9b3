#include <slipstick/interface/node_matching.h>

#include <algorithm>

namespace slipstick::interface
{
  namespace
  {
    // Weights below this are rounding.
    constexpr double smallest_weight = 1e-11;
  } // namespace

  Weights normalised(const std::map<mechanics::NodeKey, double> &raw, const double sum)
  {
    Weights weights;
    for (const auto &[key, value] : raw)
      if (std::abs(value) > smallest_weight * sum)
        weights.emplace_back(key, value / sum);
    const auto by_size = [](const auto &a, const auto &b) { return std::abs(a.second) < std::abs(b.second); };
    const auto largest = std::max_element(weights.begin(), weights.end(), by_size);
    double     others  = 0;
    for (auto w = weights.begin(); w != weights.end(); ++w)
      if (w != largest)
        others += w->second;
    largest->second = 1 - others;
    return weights;
  }
} // namespace slipstick::interface
