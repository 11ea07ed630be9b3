// Diagnosis from residuals and rows of the dual problem: energy errors, ambiguous forces, rigid motions.
#pragma once

#include <slipstick/tfeti/dual_problem.h>

namespace slipstick::tfeti
{
  /// Energies of the displacements that close given jumps.
  struct JumpEnergies
  {
    /// Where the energy of this rank's subdomains of a body is largest.
    struct Spot
    {
      double       energy    = -1; // -1: no subdomain of the body on this rank
      unsigned int subdomain = 0;  // of this rank
      unsigned int touched   = 0;  // index of the unknown in SubdomainSystem::touched()
    };
    Eigen::VectorXd   of_body; // by body, at least 0, the same on all ranks [N mm]
    std::vector<Spot> spots;   // by body
    DistributedVector forces;  // of the rows, M r on those that are kept closed [N]
  };

  /// Approximate squared energy norm of the smallest displacements that close the jumps r (owned rows) [mm]; rows
  /// without a jump are kept closed where @p held is true. Computed as r'M r [N mm], M the preconditioner or, without
  /// one, the lumped preconditioner (which gives larger values). With r = B u - c of displacements u = K+(f - B'x) + R
  /// a it is an upper bound of the squared energy norm of their error, up to the quality of the scaling of M, both in
  /// total and for each body with its own part. Collective.
  JumpEnergies jump_energies(const DualProblem &dual, const DistributedVector &r, const std::vector<bool> &held);

  /// For every owned row, whether its multiplier is undetermined because the free rows are linearly dependent
  /// (redundant constraints between bodies). This does not affect u. Collective.
  std::vector<bool> ambiguous(const DualProblem &dual, const std::vector<bool> &free);

  /// To be called where a solution failed: were the stiffnesses of the subdomains so different that the rounding of the
  /// stiffest (1e-16) is no longer small beside the softest? Collective.
  /// @throws InputError stiffnesses_too_far_apart() in that case, on all ranks.
  void refuse_stiffnesses_too_far_apart(const DualProblem &dual);

  /// The rigid motion a of the bodies for a dual vector r = G'a. Collective.
  RigidMotion motion_behind(const DualProblem &dual, const DistributedVector &r);
} // namespace slipstick::tfeti
