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
    std::vector<RigidMotion>     unresisted;  // motions that no row resists and no load drives; set to zero
  };

  /// Displacements u = K+(f - B'x) + R a. First x is corrected on the rows with `free` only, until G x = e holds to
  /// rounding, so that u is in equilibrium with x. Then the amplitudes a of the rigid motions are a least squares fit
  /// to those rows (which hold with equality). Bodies that slide on all their contacts are placed such that every slip
  /// has the direction of its force and no gap is negative, as close as possible to the position where they just stop
  /// sticking. Collective.
  /// @throws NoEquilibrium naming the body when neither free rows nor rows with friction forces fix a.
  /// @param keeps_still true: motions that no row resists and no load drives are set to zero; false: they are an error.
  Recovery recover(const DualProblem       &dual,
                   const DistributedVector &x,
                   const std::vector<bool> &free,
                   const bool               keeps_still = false);

  /// As recover() with keeps_still, but returns nothing where that throws: loads drive a motion that neither rows with
  /// `free` nor rows with friction forces resist. Collective.
  std::optional<Recovery> recover_if_held(const DualProblem       &dual,
                                          const DistributedVector &x,
                                          const std::vector<bool> &free);

  /// u += -K+ B'step + R a, x += step, with the a that is a least squares fit to the free rows. Assumes G step = 0.
  /// Updates u instead of recomputing it, so that the rounding error of x, which bends a slender subdomain by far more
  /// than that of u, does not enter again as with recover(). Collective.
  void correct(const DualProblem &dual, Recovery &at, const DistributedVector &step, const std::vector<bool> &free);

  /// Takes motions out of u that no row resists except those of auxiliary supports, whose prescribed displacements
  /// follow; unless other rows were moved by more than @p tolerated [mm]. Collective.
  /// @param free as in recover(). @return whether they were taken out.
  bool remove_motions(DualProblem                    &dual,
                      const std::vector<RigidMotion> &motions,
                      const std::vector<bool>        &free,
                      const double                    tolerated,
                      std::vector<Eigen::VectorXd>   &u);

  /// c + compliance x - B u on the free rows, 0 on the others [mm]. Collective.
  DistributedVector misfit(const DualProblem &dual, const Recovery &of, const std::vector<bool> &free);
} // namespace slipstick::tfeti
