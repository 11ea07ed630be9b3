#include <slipstick/tfeti/batches.h>
#include <slipstick/tfeti/dual_operator.h>

#include <algorithm>

namespace slipstick::tfeti
{
  std::vector<unsigned int> owners_of_ghosts(const Partitioner &rows)
  {
    std::vector<unsigned int> owners;
    for (const auto &[rank, n] : rows->ghost_targets())
      owners.insert(owners.end(), n, rank);
    return owners;
  }

  std::pair<LocalGluing, std::vector<unsigned int>> LocalGluing::make(const std::vector<Constraints::Entry> &block)
  {
    std::vector<unsigned int> touched;
    touched.reserve(block.size());
    for (const auto &entry : block)
      touched.push_back(entry.dof);
    std::sort(touched.begin(), touched.end());
    touched.erase(std::unique(touched.begin(), touched.end()), touched.end());
    LocalGluing gluing;
    gluing.entries.reserve(block.size());
    for (const auto &entry : block)
      {
        const unsigned int k = std::lower_bound(touched.begin(), touched.end(), entry.dof) - touched.begin();
        gluing.entries.push_back({entry.row, k, entry.value});
      }
    return {gluing, touched};
  }

  DualOperator::DualOperator(const std::vector<std::unique_ptr<SubdomainSystem>> &subdomains,
                             const std::vector<LocalGluing>                      &gluing,
                             const Partitioner                                   &rows,
                             const std::vector<PackedSymmetric>                  *dense_blocks)
    : subdomains(subdomains)
    , of_subdomains(gluing)
    , rows(rows)
    , owned_rows(std::make_shared<dealii::Utilities::MPI::Partitioner>(rows->locally_owned_range(),
                                                                       rows->get_mpi_communicator()))
    , blocks(dense_blocks)
    , source(rows)
    , target(rows)
  {}

  Eigen::VectorXd DualOperator::scatter(const unsigned int p, const DistributedVector &x) const
  {
    Eigen::VectorXd v = Eigen::VectorXd::Zero(subdomains[p]->touched().size());
    for (const auto &entry : of_subdomains[p].entries)
      v[entry.touched] += entry.value * x.local_element(entry.row);
    return v;
  }

  void DualOperator::gather(const unsigned int p, const Eigen::VectorXd &v, DistributedVector &y) const
  {
    for (const auto &entry : of_subdomains[p].entries)
      y.local_element(entry.row) += entry.value * v[entry.touched];
  }

  DistributedVector DualOperator::ghosted() const
  {
    return DistributedVector(rows);
  }

  DistributedVector DualOperator::zero() const
  {
    return DistributedVector(owned_rows);
  }

  void DualOperator::import(const DistributedVector &x, DistributedVector &with_ghosts) const
  {
    with_ghosts.zero_out_ghost_values();
    with_ghosts.copy_locally_owned_data_from(x);
    with_ghosts.update_ghost_values();
  }

  DistributedVector DualOperator::jumps(const std::vector<Eigen::VectorXd> &u) const
  {
    DistributedVector sum = ghosted(), y = zero();
    for (unsigned int p = 0; p < subdomains.size(); ++p)
      {
        const auto     &touched = subdomains[p]->touched();
        Eigen::VectorXd v(touched.size());
        for (unsigned int k = 0; k < touched.size(); ++k)
          v[k] = u[p][touched[k]];
        gather(p, v, sum);
      }
    sum.compress(dealii::VectorOperation::add);
    y.copy_locally_owned_data_from(sum);
    return y;
  }

  DistributedVector DualOperator::column(const unsigned int subdomain, const unsigned int touched) const
  {
    DistributedVector sum = ghosted(), y = zero();
    if (subdomain < subdomains.size())
      gather(subdomain, Eigen::VectorXd::Unit(subdomains[subdomain]->touched().size(), touched), sum);
    sum.compress(dealii::VectorOperation::add);
    y.copy_locally_owned_data_from(sum);
    return y;
  }

  std::vector<Eigen::VectorXd> DualOperator::forces(const DistributedVector &x) const
  {
    DistributedVector all = ghosted();
    import(x, all);
    std::vector<Eigen::VectorXd> result;
    for (unsigned int p = 0; p < subdomains.size(); ++p)
      {
        const Eigen::VectorXd at_touched = scatter(p, all);
        const auto           &touched    = subdomains[p]->touched();
        result.push_back(Eigen::VectorXd::Zero(subdomains[p]->n_unknowns()));
        for (unsigned int k = 0; k < touched.size(); ++k)
          result[p][touched[k]] = at_touched[k];
      }
    return result;
  }

  template <class Products>
  void DualOperator::apply(const DistributedVector &x, DistributedVector &y, const Products &add_products) const
  {
    ++applications;
    import(x, source);
    target.zero_out_ghost_values();
    target = 0;
    add_products();
    target.compress(dealii::VectorOperation::add);
    y.copy_locally_owned_data_from(target);
  }

  void DualOperator::apply(const DistributedVector &x, DistributedVector &y) const
  {
    if (!is_explicit())
      return apply_by_solves(x, y);
    apply(x, y, [this]() {
      Eigen::VectorXd at_touched;
      for (unsigned int p = 0; p < subdomains.size(); ++p)
        {
          (*blocks)[p].multiply(scatter(p, source), at_touched);
          gather(p, at_touched, target);
        }
    });
  }

  void DualOperator::apply_by_solves(const DistributedVector &x, DistributedVector &y) const
  {
    apply(x, y, [this]() {
      for (const auto &batch :
           batches(subdomains.size(), [this](const unsigned int p) { return subdomains[p]->factor(); }))
        add_solutions(batch);
    });
  }

  // Applies the K+ of subdomains with the same factor to forces at the touched unknowns.
  void DualOperator::add_solutions(const std::vector<unsigned int> &batch) const
  {
    Eigen::MatrixXd full = Eigen::MatrixXd::Zero(subdomains[batch.front()]->n_unknowns(), batch.size());
    for (unsigned int k = 0; k < batch.size(); ++k)
      full.col(k)(subdomains[batch[k]]->touched()) = scatter(batch[k], source);
    subdomains[batch.front()]->apply_pseudo_inverse(full);
    for (unsigned int k = 0; k < batch.size(); ++k)
      gather(batch[k], full.col(k)(subdomains[batch[k]]->touched()), target);
  }

  std::size_t DualOperator::block_bytes() const
  {
    std::size_t n = 0;
    if (blocks)
      for (const auto &block : *blocks)
        n += block.bytes();
    return n;
  }
} // namespace slipstick::tfeti
