#include <slipstick/tfeti/preconditioner.h>

namespace slipstick::tfeti
{
  RowPreconditioner::RowPreconditioner(const std::vector<std::unique_ptr<SubdomainSystem>> &subdomains_,
                                       const std::vector<LocalGluing>                      &gluing,
                                       const DualOperator                                  &F,
                                       const Partitioner                                   &rows,
                                       const MPI_Comm                                       comm,
                                       std::vector<PackedSymmetric>                         blocks_)
    : subdomains(subdomains_)
    , scatter_gather(F)
    , row_weights(subdomains, gluing, rows, comm)
    , blocks(std::move(blocks_))
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
        const Eigen::VectorXd move = inverse_diagonals[p].cwiseProduct(scatter_gather.scatter(p, source));
        if (blocks.empty())
          force = subdomains[p]->apply_touched_stiffness(move);
        else
          blocks[p].multiply(move, force);
        scatter_gather.gather(p, inverse_diagonals[p].cwiseProduct(force), target);
      }
    target.compress(dealii::VectorOperation::add);
    DistributedVector weighted(z);
    weighted.copy_locally_owned_data_from(target);
    inverse.apply(weighted, z);
  }
} // namespace slipstick::tfeti
