#include <slipstick/tfeti/preconditioner.h>

namespace slipstick::tfeti
{
  RowPreconditioner::RowPreconditioner(const std::vector<std::unique_ptr<SubdomainSystem>> &subdomains_,
                                       const std::vector<LocalGluing>                      &gluing,
                                       const DualOperator                                  &F,
                                       const Partitioner                                   &rows,
                                       const MPI_Comm                                       comm,
                                       const std::vector<PackedSymmetric>                  *blocks_)
    : subdomains(subdomains_)
    , scatter_gather(F)
    , row_weights(subdomains, gluing, rows, comm)
    , blocks(blocks_)
    , source(rows)
    , target(rows)
  {
    for (const auto &system : subdomains)
      inverse_diagonals.push_back(system->touched_diagonal().cwiseInverse());
  }

  void RowPreconditioner::apply(const RowWeights::Inverse &inverse,
                                const DistributedVector   &r,
                                DistributedVector         &z) const
  {
    inverse.apply(r, z);
    scatter_gather.import(z, source);
    target.zero_out_ghost_values();
    target = 0;
    Eigen::VectorXd force;
    for (unsigned int p = 0; p < subdomains.size(); ++p)
      {
        multiply(p, move(p), force);
        scatter_gather.gather(p, inverse_diagonals[p].cwiseProduct(force), target);
      }
    target.compress(dealii::VectorOperation::add);
    DistributedVector weighted(z);
    weighted.copy_locally_owned_data_from(target);
    inverse.apply(weighted, z);
  }

  std::vector<Eigen::VectorXd> RowPreconditioner::energies(const RowWeights::Inverse &inverse,
                                                           const DistributedVector   &r) const
  {
    DistributedVector weighted(r);
    inverse.apply(r, weighted);
    scatter_gather.import(weighted, source);
    std::vector<Eigen::VectorXd> result;
    Eigen::VectorXd              force;
    for (unsigned int p = 0; p < subdomains.size(); ++p)
      {
        result.push_back(move(p));
        multiply(p, result.back(), force);
        result.back().array() *= force.array();
      }
    return result;
  }

  Eigen::VectorXd RowPreconditioner::move(const unsigned int p) const
  {
    return inverse_diagonals[p].cwiseProduct(scatter_gather.scatter(p, source));
  }

  void RowPreconditioner::multiply(const unsigned int p, const Eigen::VectorXd &move, Eigen::VectorXd &force) const
  {
    if (!blocks)
      force = subdomains[p]->apply_touched_stiffness(move);
    else if (subdomains[p]->has_schur_complement())
      force = subdomains[p]->apply_schur_complement(move);
    else
      (*blocks)[p].multiply(move, force);
  }
} // namespace slipstick::tfeti
