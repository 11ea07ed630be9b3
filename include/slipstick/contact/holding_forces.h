// Forces that hold the bodies, and what is left of their balance once the bodies are displaced.
#pragma once

#include <slipstick/tfeti/dual_problem.h>

#include <Eigen/Dense>

#include <vector>

namespace slipstick::contact
{
  /// Nodal forces of supports, foundations, bonds and contact on the subdomains of this rank [N]: all forces of the
  /// multipliers except those between subdomains of one body. Collective.
  std::vector<Eigen::VectorXd> holding_forces(const tfeti::DualProblem       &dual,
                                              const tfeti::DistributedVector &multipliers);

  /// Linear theory balances forces F where they act on the undeformed bodies. Displaced by u they leave the moment
  /// sum u x F of a body. It is small beside the moments that hold the body unless the body rotates or rolls.
  struct DisplacedMoments
  {
    Eigen::VectorXd left;    // by body: magnitude of the moment that is left [N mm]
    Eigen::VectorXd holding; // by body: sum of the magnitudes of the moments of the holding forces about their mean
                             // position, which is weighted by their magnitudes [N mm]
    Eigen::VectorXd forces;  // by body: sum of the magnitudes of the holding forces [N]
  };

  /// @param u displacements by subdomain [mm]; loads of the dual problem must not contain those of initial strains.
  /// Collective.
  DisplacedMoments displaced_moments(const tfeti::DualProblem           &dual,
                                     const std::vector<Eigen::VectorXd> &u,
                                     const tfeti::DistributedVector     &multipliers,
                                     const unsigned int                  n_bodies);
} // namespace slipstick::contact
