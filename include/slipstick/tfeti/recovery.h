// Displacements of the torn bodies from the multipliers.
#pragma once

#include <slipstick/tfeti/dual_problem.h>

#include <optional>

namespace slipstick::tfeti
{
  /// The primal solution and the multipliers that belong to it.
  struct Recovery
  {
    std::vector<Eigen::VectorXd> u;           // of this rank's subdomains [mm]
    DistributedVector            multipliers; // [N]
    std::vector<RigidMotion>     unresisted;  // motions that nothing resists and no load drives: they are set to zero
  };

  /// Displacements u = K+(f - B'x) + R a. First x is corrected, only on the rows with `free`, until G x = e holds to
  /// rounding, so that u is in equilibrium with it; then the amplitudes a of the rigid motions fit those rows (which
  /// hold with equality) in the sense of least squares. Bodies that slide on all their contacts are placed such that
  /// every slip follows its force and no gap is negative, as close as possible to where they just stop sticking.
  /// Collective.
  /// @throws NoEquilibrium naming the body when neither free rows nor rows with friction forces fix a.
  /// @param keeps_still motions that nothing resists and no load drives stay at zero; otherwise they are an error.
  Recovery recover(const DualProblem       &dual,
                   const DistributedVector &x,
                   const std::vector<bool> &free,
                   const bool               keeps_still = false);

  /// As recover() with keeps_still; nothing where that throws, since loads drive a motion that neither rows with `free` nor rows
  /// with friction forces resist. Collective.
  std::optional<Recovery> recover_if_held(const DualProblem       &dual,
                                          const DistributedVector &x,
                                          const std::vector<bool> &free);

  /// u += -K+ B'step + R a, x += step, with the a that fits the free rows in the sense of least squares. G step = 0
  /// is assumed. The present u is kept, so that rounding of x, under which a slender subdomain bends far more than u,
  /// does not enter again, as it would with recover(). Collective.
  void correct(const DualProblem &dual, Recovery &at, const DistributedVector &step, const std::vector<bool> &free);

  /// c + compliance x - B u on the free rows, 0 on the others [mm]. Collective.
  DistributedVector misfit(const DualProblem &dual, const Recovery &of, const std::vector<bool> &free);
} // namespace slipstick::tfeti
