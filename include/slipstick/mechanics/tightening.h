// Shortening of bolts such that they carry prescribed forces.
#pragma once

#include <Eigen/Dense>

#include <cmath>
#include <optional>
#include <vector>

namespace slipstick::mechanics
{
  /// Solves for the shortenings of n bolts that give prescribed tensions, by the BFGS method (Broyden, Fletcher,
  /// Goldfarb, Shanno 1970), starting from the stiffness of the bolts alone; exact after the second solve if a single
  /// bolt, or several equal ones, load the bodies and no gap has to close first. The shortening of a bolt without
  /// tension is doubled in every attempt; a single bolt stays within the bounds found for it.
  class Tightening
  {
  public:
    Tightening() = default;

    /// @param stiffnesses of the bolts [N/mm]. @param lengths [mm]
    Tightening(const std::vector<double> &stiffnesses, const std::vector<double> &lengths);

    /// Starts a load step. @param wanted prescribed tensions [N], > 0; none where the length is kept.
    void begin(std::vector<std::optional<double>> wanted);

    /// Stores the tensions [N] for the last shortening. @return whether the prescribed tensions are reached.
    bool take(const std::vector<double> &tensions, const double tolerance);

    /// Chooses the next shortening. @return the number of a bolt that is shortened by more than its length, if any.
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

    /// Largest deviation of the tensions of take() from the prescribed ones, over the largest of these.
    double miss() const;

    /// Whether the tensions were inconsistent in the last call of move(), because the solver left too large errors in
    /// them.
    bool are_vague() const
    {
      return tensions_are_vague;
    }

    /// The data that later steps depend on, as numbers (for a restart).
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
    bool                               has_known          = true;  // s_known, N_known belong to the same loads
    bool                               is_scaled          = false; // J, by a first pair of tensions and shortenings
    bool                               tensions_are_vague = false;
    unsigned int                       n_loose            = 0; // attempts without tension
    double low = -HUGE_VAL, high = HUGE_VAL;                   // of a single bolt: shortening too small, too large [mm]
  };
} // namespace slipstick::mechanics
