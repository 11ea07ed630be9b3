#include <slipstick/tfeti/dense.h>
#include <slipstick/tfeti/least_violation.h>

#include <algorithm>
#include <vector>

namespace slipstick::tfeti
{
  namespace
  {
    // The maximum number of steps, and the part of a at which a change ends the search.
    constexpr unsigned int max_steps         = 100;
    constexpr double       negligible_change = 1e-14;
    // Conditions whose rates differ by less than this part of them differ by rounding: no motion can meet one of them
    // without the other.
    constexpr double rounding_of_rates = 1e-10;

    /// The t > 0 that minimises the sum of squares of the negative entries of values + t rates. Its slope is negative
    /// at t = 0.
    double least_violation_along(const Eigen::VectorXd &values, const Eigen::VectorXd &rates)
    {
      const auto slope = [&](const double t) { return (values + t * rates).cwiseMin(0).dot(rates); };

      std::vector<double> kinks = {0.};
      for (Eigen::Index i = 0; i < values.size(); ++i)
        if (values[i] < 0 ? rates[i] > 0 : rates[i] < 0)
          kinks.push_back(-values[i] / rates[i]);
      std::sort(kinks.begin(), kinks.end());
      // linear from the last kink with a negative slope on, and not decreasing
      const auto   next = std::partition_point(kinks.begin() + 1, kinks.end(), [&](double t) { return slope(t) < 0; });
      const double from = *(next - 1), to = next == kinks.end() ? from + 1 : *next;
      const double at_from = slope(from), rise = slope(to) - at_from;
      return rise > 0 ? from - (to - from) * at_from / rise : from;
    }
  } // namespace

  Eigen::VectorXd least_violation(const Eigen::VectorXd &values, const Eigen::MatrixXd &rates)
  {
    Eigen::VectorXd a = Eigen::VectorXd::Zero(rates.cols());
    for (unsigned int step = 0; step < max_steps; ++step)
      {
        const Eigen::VectorXd     reached = values + rates * a;
        std::vector<Eigen::Index> violated;
        for (Eigen::Index i = 0; i < reached.size(); ++i)
          if (reached[i] < 0)
            violated.push_back(i);
        if (violated.empty())
          break;
        Eigen::MatrixXd their_rates(violated.size(), rates.cols());
        Eigen::VectorXd by(violated.size());
        for (std::size_t i = 0; i < violated.size(); ++i)
          {
            their_rates.row(i) = rates.row(violated[i]);
            by[i]              = -reached[violated[i]];
          }
        const Eigen::VectorXd towards = shortest_solution(their_rates, by, rounding_of_rates);
        const Eigen::VectorXd change  = least_violation_along(reached, rates * towards) * towards;
        a += change;
        if (change.norm() <= negligible_change * a.norm())
          break;
      }
    return a;
  }
} // namespace slipstick::tfeti
