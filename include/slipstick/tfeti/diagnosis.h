// What residuals and rows of the dual problem say about the bodies: errors in energy, ambiguous forces, motions.
#pragma once

#include <slipstick/tfeti/dual_problem.h>

namespace slipstick::tfeti
{
  /// Energies of displacements that close jumps.
  struct JumpEnergies
  {
    /// Where the energy of this rank's subdomains of a body is largest.
    struct Spot
    {
      double       energy    = -1; // none of its subdomains here
      unsigned int subdomain = 0;  // of this rank
      unsigned int touched   = 0;  // the unknown: its number among the touched ones
    };
    Eigen::VectorXd   of_body; // on all ranks [N mm]
    std::vector<Spot> spots;   // by body
  };

  /// Nearly the squared energy norm of the smallest displacements that close jumps r (owned rows) [mm], where rows
  /// without a jump are held if @p held says so: r'M r [N mm], M the preconditioner or, without one, the lumped
  /// preconditioner (which gives more). With r = B u - c of displacements u = K+(f - B'x) + R a it is an upper bound
  /// of the squared energy norm of their error, up to the quality of the scaling of M, both in total and for each
  /// body with its own part. Collective.
  JumpEnergies jump_energies(const DualProblem &dual, const DistributedVector &r, const std::vector<bool> &held);

  /// For every owned row, whether its multiplier is undetermined because the free rows are linearly dependent (bodies
  /// that hold each other in more ways than one). This does not affect u. Collective.
  std::vector<bool> ambiguous(const DualProblem &dual, const std::vector<bool> &free);

  /// The rigid motion of the bodies behind a dual vector r = G'a. Collective.
  RigidMotion motion_behind(const DualProblem &dual, const DistributedVector &r);
} // namespace slipstick::tfeti
