// Rigid motions of whole bodies: which are free, and what to call them.
#pragma once

#include <slipstick/tfeti/dual_operator.h>

namespace slipstick::tfeti
{
  /// A rigid motion of one or more bodies: amplitudes of translation x, translation y, rotation of every body.
  struct RigidMotion
  {
    Eigen::VectorXd amplitudes; // 3 a body, of unit length
    double          work = 0;   // of the loads along it, over |loads| [-]
  };

  /// Motions of the bodies that no active row of B resists (gluing aside, which moves with its body). Collective.
  /// @param active rows (owned by this rank) that take part; empty: all.
  std::vector<RigidMotion> free_motions(const std::vector<std::unique_ptr<SubdomainSystem>> &subdomains,
                                        const std::vector<LocalGluing>                      &gluing,
                                        const Constraints                                   &constraints,
                                        const std::vector<bool>                             &active,
                                        const unsigned int                                   n_bodies,
                                        const MPI_Comm                                       comm);

  /// The motion of whole bodies in amplitudes of the rigid motions of this rank's subdomains (their mean). Collective.
  RigidMotion body_motion(const std::vector<std::unique_ptr<SubdomainSystem>> &subdomains,
                          const Eigen::VectorXd                               &amplitudes,
                          const unsigned int                                   n_bodies,
                          const MPI_Comm                                       comm);

  /// "body box: translation along (1, 0)", "body a: rotation ..."; names the bodies that move most.
  std::string describe(const RigidMotion &motion, const std::vector<std::string> &body_names);
} // namespace slipstick::tfeti
