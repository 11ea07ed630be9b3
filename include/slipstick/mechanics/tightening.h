// By how much bolts are shortened, so that they bear the forces that are asked for.
#pragma once

#include <Eigen/Dense>

#include <cmath>
#include <optional>
#include <vector>

namespace slipstick::mechanics
{
  /// The tensions of n bolts as functions of how much they are shortened are solved for by Broyden's method (good, 1965),
  /// from the stiffness of the bolts alone; exact after the second solve where nothing but the bolts loads the bodies and no
  /// gap has to be closed first. A bolt that bears nothing yet is shortened twice as far every time; a single bolt keeps
  /// within the bounds that were found for it.
  class Tightening
  {
  public:
    Tightening() = default;

    /// @param stiffnesses of the bolts [N/mm]. @param lengths [mm]
    Tightening(const std::vector<double> &stiffnesses, const std::vector<double> &lengths);

    /// A load step begins. @param wanted tensions [N], > 0; none where the length is held.
    void begin(std::vector<std::optional<double>> wanted);

    /// The tensions [N] with the shortening tried last. @return whether those that are given are right.
    bool take(const std::vector<double> &tensions, const double tolerance);

    /// Next attempt. @return the number of a bolt that is shortened by more than its length, if any.
    std::optional<unsigned int> move();

    bool is_given(const unsigned int bolt) const
    {
      return wanted[bolt].has_value();
    }
    bool any_is_given() const;

    const std::vector<double> &shortening() const // [mm]
    {
      return s;
    }
    const std::vector<double> &tensions() const // [N], of take()
    {
      return N;
    }

    /// By how much the tensions of take() miss those that are wanted, over the largest of these.
    double miss() const;

    /// Did the tensions contradict each other when move() was called last? Then the solver left too large errors in them.
    bool are_vague() const
    {
      return tensions_are_vague;
    }

    /// What later steps go by, as numbers.
    std::vector<std::vector<double>> state() const;
    void                             restore(const std::vector<std::vector<double>> &state);

  private:
    bool is_loose(const unsigned int bolt, const std::vector<double> &tensions) const;
    void learn();
    void forget_bounds();
    void keep_within_bounds(const unsigned int bolt);

    std::vector<double>                length;           // [mm]
    std::vector<double>                s, N;             // of the last attempt
    std::vector<double>                s_known, N_known; // of the attempt before it
    Eigen::MatrixXd                    J;                // dN/ds [N/mm]
    std::vector<std::optional<double>> wanted;
    bool                               has_known          = true; // are s_known, N_known of the same loads?
    bool                               tensions_are_vague = false;
    unsigned int                       n_loose            = 0; // attempts without tension
    double low = -HUGE_VAL, high = HUGE_VAL;                   // of a single bolt: too short a way, too long a way [mm]
  };
} // namespace slipstick::mechanics
