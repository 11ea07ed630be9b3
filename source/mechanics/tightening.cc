#include <slipstick/mechanics/tightening.h>

#include <algorithm>
#include <cmath>

namespace slipstick::mechanics
{
  namespace
  {
    // Initial guess of the stiffness of bolt and clamped parts in series, relative to that of the bolt.
    constexpr double first_part = 0.5;
    // A bolt with less than this fraction of the prescribed tension is loose: its response is not used to update
    // stiffnesses.
    constexpr double loose_part = 1e-3;
    // Factor by which the shortening of a loose bolt is increased in every attempt.
    constexpr double growth = 2;
    // Largest step, over the shortening or the step that this bolt alone would take.
    constexpr double longest_step = 4;
    // Lower limit of stiffnesses along a step that are learned, over those assumed.
    constexpr double least_part = 1e-3;
    // Minimum distance of an attempt from the nearer bound, relative to the interval.
    constexpr double from_bounds = 0.05;
  } // namespace

  Tightening::Tightening(const std::vector<double> &stiffnesses, const std::vector<double> &lengths)
    : length(lengths)
    , s(stiffnesses.size(), 0.)
    , N(s)
    , s_known(s)
    , N_known(s)
    , J(Eigen::MatrixXd::Zero(s.size(), s.size()))
    , wanted(s.size())
  {
    for (std::size_t i = 0; i < s.size(); ++i)
      J(i, i) = first_part * stiffnesses[i];
  }

  bool Tightening::any_is_given() const
  {
    return std::any_of(wanted.begin(), wanted.end(), [](const auto &force) { return force.has_value(); });
  }

  bool Tightening::is_loose(const unsigned int bolt, const std::vector<double> &tensions) const
  {
    return wanted[bolt] && tensions[bolt] < loose_part * *wanted[bolt];
  }

  void Tightening::begin(std::vector<std::optional<double>> wanted_)
  {
    wanted = std::move(wanted_);
    forget_bounds();
    if (any_is_given())
      move();
    forget_bounds(); // discards bounds found for other loads
  }

  void Tightening::forget_bounds()
  {
    n_loose = 0;
    low     = -HUGE_VAL;
    high    = HUGE_VAL;
  }

  double Tightening::miss() const
  {
    double largest = 0, missing = 0;
    for (std::size_t i = 0; i < s.size(); ++i)
      if (wanted[i])
        {
          largest = std::max(largest, *wanted[i]);
          missing = std::max(missing, std::abs(*wanted[i] - N[i]));
        }
    return largest > 0 ? missing / largest : 0.;
  }

  bool Tightening::take(const std::vector<double> &tensions, const double tolerance)
  {
    N                   = tensions;
    const bool is_right = miss() <= tolerance;
    if (is_right)
      has_known = false; // the loads of the next step change the tensions
    else
      learn();
    return is_right;
  }

  // The tensions are the derivative of a convex energy with respect to the shortenings, so that J is symmetric and
  // positive definite: BFGS update for the bolts that are not loose. The first one scales the initial guess before.
  void Tightening::learn()
  {
    const bool from_nothing = std::all_of(s_known.begin(), s_known.end(), [](const double x) { return x == 0; });
    std::vector<Eigen::Index> bears;
    for (std::size_t i = 0; i < s.size(); ++i)
      if (wanted[i] && !is_loose(i, N) && (from_nothing || !is_loose(i, N_known)))
        bears.push_back(i);
    const Eigen::Index n = bears.size();
    Eigen::VectorXd    step(n), change(n);
    for (Eigen::Index a = 0; a < n; ++a)
      {
        step[a]   = s[bears[a]] - s_known[bears[a]];
        change[a] = N[bears[a]] - N_known[bears[a]];
      }
    Eigen::MatrixXd part     = J(bears, bears);
    const double    energy   = step.dot(change);
    double          expected = step.dot(part * step);
    if (has_known && energy > least_part * expected)
      {
        if (!is_scaled)
          {
            part *= energy / expected;
            expected = energy;
          }
        is_scaled                  = true;
        const Eigen::VectorXd left = part * step;
        part += change * change.transpose() / energy - left * left.transpose() / expected;
        J(bears, bears) = part;
      }
    s_known   = s;
    N_known   = N;
    has_known = true;
  }

  std::optional<unsigned int> Tightening::move()
  {
    std::vector<unsigned int> given;
    for (unsigned int i = 0; i < s.size(); ++i)
      if (wanted[i])
        given.push_back(i);
    const Eigen::Index m = given.size();
    Eigen::MatrixXd    stiffness(m, m);
    Eigen::VectorXd    missing(m);
    bool               any_loose = false;
    for (Eigen::Index a = 0; a < m; ++a)
      {
        missing[a] = *wanted[given[a]] - N[given[a]];
        any_loose  = any_loose || (s[given[a]] > 0 && is_loose(given[a], N));
        for (Eigen::Index b = 0; b < m; ++b)
          stiffness(a, b) = J(given[a], given[b]);
      }
    tensions_are_vague         = false;
    n_loose                    = any_loose ? n_loose + 1 : 0;
    const Eigen::VectorXd step = stiffness.partialPivLu().solve(missing);
    for (Eigen::Index a = 0; a < m; ++a)
      {
        const unsigned int i     = given[a];
        const double       plain = missing[a] / J(i, i);
        const double       most  = longest_step * std::max(std::abs(plain), std::abs(s[i]));
        const double       by    = std::isfinite(step[a]) ? std::clamp(step[a], -most, most) : plain;
        if (m == 1)
          (missing[a] > 0 ? low : high) = s[i];
        s[i] += is_loose(i, N) && s[i] > 0 ? std::pow(growth, n_loose - 1) * plain : by;
        if (m > 1)
          continue;
        if (J(i, i) * (high - low) < std::abs(missing[a])) // within the interval the bolt cannot reach its force
          {
            forget_bounds();
            tensions_are_vague = true;
          }
        keep_within_bounds(i);
      }
    for (const unsigned int i : given)
      if (s[i] > length[i])
        return i;
    return {};
  }

  void Tightening::keep_within_bounds(const unsigned int i)
  {
    if (!std::isfinite(high) || !std::isfinite(low) || !(low < high))
      return;
    const double margin = from_bounds * (high - low);
    if (s[i] < low + margin || s[i] > high - margin)
      s[i] = (low + high) / 2;
  }

  std::vector<std::vector<double>> Tightening::state() const
  {
    return {s, N, std::vector<double>(J.data(), J.data() + J.size()), {is_scaled ? 1. : 0.}};
  }

  void Tightening::restore(const std::vector<std::vector<double>> &state)
  {
    if (s.empty())
      return;
    s = state[0];
    N = state[1];
    std::copy(state[2].begin(), state[2].end(), J.data());
    is_scaled = state[3][0] > 0;
    has_known = false;
  }
} // namespace slipstick::mechanics
