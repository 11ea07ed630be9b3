#include <slipstick/tfeti/diagnosis.h>

#include <slipstick/tfeti/row_metric.h>

#include <deal.II/base/mpi.h>

#include <algorithm>
#include <limits>
#include <optional>

namespace slipstick::tfeti
{
  namespace
  {
    // Beyond it the rounding of the stiffest subdomain (1e-16) is more than 1e-4 of the softest, and checks may fail.
    constexpr double largest_stiffness_ratio = 1e12;
  } // namespace

  JumpEnergies jump_energies(const DualProblem &dual, const DistributedVector &r, const std::vector<bool> &held)
  {
    const auto                      &systems = dual.subdomains();
    const DualOperator              &F       = dual.dual_operator();
    const MPI_Comm                   comm    = dual.communicator();
    std::optional<RowPreconditioner> lumped;
    if (!dual.preconditioner())
      lumped.emplace(systems, F.gluing(), F, dual.constraints().rows, comm, nullptr);
    const RowPreconditioner  &M = lumped ? *lumped : *dual.preconditioner();
    const RowWeights::Inverse weights(M.weights(), held);
    const auto                energies = M.energies(weights, r);
    const std::size_t         n_bodies = dual.body_motions().names().size();
    JumpEnergies result{Eigen::VectorXd::Zero(n_bodies), std::vector<JumpEnergies::Spot>(n_bodies), dual.zero()};
    M.apply(weights, r, result.forces);
    for (unsigned int p = 0; p < systems.size(); ++p)
      {
        const unsigned int body = systems[p]->body();
        result.of_body[body] += energies[p].sum();
        Eigen::Index k;
        if (energies[p].size() > 0 && energies[p].maxCoeff(&k) > result.spots[body].energy)
          result.spots[body] = {energies[p][k], p, static_cast<unsigned int>(k)};
      }
    MPI_Allreduce(MPI_IN_PLACE, result.of_body.data(), result.of_body.size(), MPI_DOUBLE, MPI_SUM, comm);
    result.of_body = result.of_body.cwiseMax(0.); // rounding may be negative
    return result;
  }

  std::vector<bool> ambiguous(const DualProblem &dual, const std::vector<bool> &free)
  {
    const auto       &compliance = dual.constraints().compliance;
    std::vector<bool> rigid      = free; // rows with compliance are uniquely determined by it
    for (unsigned int r = 0; r < compliance.size(); ++r)
      rigid[r] = rigid[r] && compliance[r] == 0;
    if (dual.preconditioner())
      return dual.preconditioner()->weights().ambiguous(rigid);
    return RowWeights(dual.subdomains(), dual.dual_operator().gluing(), dual.constraints().rows, dual.communicator())
      .ambiguous(rigid);
  }

  void refuse_stiffnesses_too_far_apart(const DualProblem &dual)
  {
    double largest = 0, smallest = std::numeric_limits<double>::infinity();
    for (const auto &system : dual.subdomains())
      {
        const double stiffness = system->stiffness_diagonal().maxCoeff();
        largest                = std::max(largest, stiffness);
        smallest               = std::min(smallest, stiffness);
      }
    largest  = dealii::Utilities::MPI::max(largest, dual.communicator());
    smallest = dealii::Utilities::MPI::min(smallest, dual.communicator());
    if (largest > largest_stiffness_ratio * smallest)
      throw stiffnesses_too_far_apart();
  }

  RigidMotion motion_behind(const DualProblem &dual, const DistributedVector &r)
  {
    return body_motion(dual.subdomains(),
                       dual.projector().amplitudes(r),
                       dual.body_motions().names().size(),
                       dual.communicator());
  }
} // namespace slipstick::tfeti
