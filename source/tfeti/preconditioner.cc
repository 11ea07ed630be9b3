#include <slipstick/tfeti/batches.h>
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
    for_products([this](const unsigned int p, const Eigen::VectorXd &, const Eigen::VectorXd &force) {
      scatter_gather.gather(p, inverse_diagonals[p].cwiseProduct(force), target);
    });
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
    std::vector<Eigen::VectorXd> result(subdomains.size());
    for_products([&result](const unsigned int p, const Eigen::VectorXd &move, const Eigen::VectorXd &force) {
      result[p] = move.cwiseProduct(force);
    });
    return result;
  }

  Eigen::VectorXd RowPreconditioner::move(const unsigned int p) const
  {
    return inverse_diagonals[p].cwiseProduct(scatter_gather.scatter(p, source));
  }

  template <class F>
  void RowPreconditioner::for_products(const F &f) const
  {
    const auto factor = [this](const unsigned int p) { return blocks ? subdomains[p]->inner_factor() : nullptr; };
    for (const auto &batch : batches(subdomains.size(), factor))
      {
        std::vector<const SubdomainSystem *> systems;
        std::vector<Eigen::VectorXd>         moves, forces;
        for (const unsigned int p : batch)
          {
            systems.push_back(subdomains[p].get());
            moves.push_back(move(p));
          }
        if (factor(batch.front()))
          SubdomainSystem::apply_schur_complements(systems, forces = moves);
        else if (blocks)
          (*blocks)[batch.front()].multiply(moves.front(), forces.emplace_back());
        else
          forces.push_back(systems.front()->apply_touched_stiffness(moves.front()));
        for (unsigned int k = 0; k < batch.size(); ++k)
          f(batch[k], moves[k], forces[k]);
      }
  }
} // namespace slipstick::tfeti
