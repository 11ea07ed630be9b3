#include <slipstick/base/exceptions.h>
#include <slipstick/tfeti/row_weights.h>

#include <deal.II/base/mpi.h>

#include <boost/serialization/vector.hpp>

#include <numeric>

namespace slipstick::tfeti
{
  namespace
  {
    // Blocks of more rows are factorised as sparse ones.
    constexpr unsigned int largest_dense_block = 32;

    /// One summand of an entry of W.
    struct Weight
    {
      std::uint64_t row = 0, column = 0; // global
      double        value = 0;

      template <class Archive>
      void serialize(Archive &archive, const unsigned int /*version*/)
      {
        archive &row &column &value;
      }
    };

    /// Summands of W that one subdomain gives: pairs of rows that touch the same unknown.
    std::vector<Weight> weights_of(const SubdomainSystem &subdomain, const LocalGluing &gluing, const Partitioner &rows)
    {
      std::vector<std::vector<std::pair<std::uint64_t, double>>> by_unknown(subdomain.touched().size());
      for (const auto &entry : gluing.entries)
        by_unknown[entry.touched].emplace_back(rows->local_to_global(entry.row), entry.value);
      std::vector<Weight>   weights;
      const Eigen::VectorXd diagonal = subdomain.touched_diagonal();
      for (unsigned int k = 0; k < by_unknown.size(); ++k)
        for (const auto &[row, a] : by_unknown[k])
          for (const auto &[column, b] : by_unknown[k])
            weights.push_back({row, column, a * b / diagonal[k]});
      return weights;
    }
  } // namespace

  RowWeights::RowWeights(const std::vector<std::unique_ptr<SubdomainSystem>> &subdomains,
                         const std::vector<LocalGluing>                      &gluing,
                         const Partitioner                                   &rows,
                         const MPI_Comm                                       comm)
  {
    std::map<unsigned int, std::vector<Weight>> to_send;
    const auto                                  owners = owners_of_ghosts(rows);
    const unsigned int                          rank   = dealii::Utilities::MPI::this_mpi_process(comm);
    const unsigned int                          n      = rows->locally_owned_size();
    for (unsigned int p = 0; p < subdomains.size(); ++p)
      for (const auto &weight : weights_of(*subdomains[p], gluing[p], rows))
        {
          const unsigned int local = rows->global_to_local(weight.row);
          to_send[local < n ? rank : owners[local - n]].push_back(weight);
        }

    // sums, and the groups of rows that hang together
    std::map<std::pair<unsigned int, unsigned int>, double> sums;
    std::vector<unsigned int>                               root(n);
    std::iota(root.begin(), root.end(), 0);
    const auto find = [&root](unsigned int r) {
      while (root[r] != r)
        r = root[r] = root[root[r]];
      return r;
    };
    bool is_local = true;
    for (const auto &[from, weights] : dealii::Utilities::MPI::some_to_some(comm, to_send))
      for (const auto &weight : weights)
        {
          is_local = is_local && rows->in_local_range(weight.column);
          if (!rows->in_local_range(weight.column))
            continue;
          const unsigned int r = rows->global_to_local(weight.row), c = rows->global_to_local(weight.column);
          sums[{r, c}] += weight.value;
          const unsigned int a = find(r), b = find(c);
          root[std::max(a, b)] = std::min(a, b);
        }
    if (dealii::Utilities::MPI::min(static_cast<int>(is_local), comm) == 0)
      throw NumericalError("rows that share a node are owned by different ranks",
                           "this is a bug of slipstick, please report it");

    std::map<unsigned int, unsigned int>               block_of_root;
    std::vector<std::pair<unsigned int, unsigned int>> place(n); // block, position in it
    for (unsigned int r = 0; r < n; ++r)
      {
        const auto [entry, is_new] = block_of_root.emplace(find(r), blocks.size());
        if (is_new)
          blocks.emplace_back();
        place[r] = {entry->second, blocks[entry->second].rows.size()};
        blocks[entry->second].rows.push_back(r);
      }
    std::vector<std::vector<Eigen::Triplet<double>>> entries(blocks.size());
    for (const auto &[position, value] : sums)
      entries[place[position.first].first].emplace_back(place[position.first].second,
                                                        place[position.second].second,
                                                        value);
    for (unsigned int b = 0; b < blocks.size(); ++b)
      {
        blocks[b].matrix.resize(blocks[b].rows.size(), blocks[b].rows.size());
        blocks[b].matrix.setFromTriplets(entries[b].begin(), entries[b].end());
        blocks[b].inverse = inverse(blocks[b], {});
      }
  }

  std::vector<double> RowWeights::stiffnesses() const
  {
    std::size_t n = 0;
    for (const auto &block : blocks)
      n += block.rows.size();
    std::vector<double> result(n);
    for (const auto &block : blocks)
      for (unsigned int k = 0; k < block.rows.size(); ++k)
        result[block.rows[k]] = 1 / block.matrix.coeff(k, k);
    return result;
  }

  // of the active rows of a block; nothing if there are none
  std::shared_ptr<const RowWeights::Inverse::Block> RowWeights::inverse(const Block             &full,
                                                                        const std::vector<bool> &active) const
  {
    const auto is_active = [&active](const unsigned int row) { return active.empty() || active[row]; };
    if (full.inverse && std::all_of(full.rows.begin(), full.rows.end(), is_active))
      return full.inverse;
    std::vector<int> kept(full.rows.size(), -1); // position among the active rows
    auto             block = std::make_shared<Inverse::Block>();
    for (unsigned int k = 0; k < full.rows.size(); ++k)
      if (is_active(full.rows[k]))
        {
          kept[k] = block->rows.size();
          block->rows.push_back(full.rows[k]);
        }
    const unsigned int n = block->rows.size();
    if (n == 0)
      return nullptr;
    std::vector<Eigen::Triplet<double>> entries;
    for (unsigned int k = 0; k < full.rows.size(); ++k)
      if (kept[k] >= 0)
        for (Eigen::SparseMatrix<double>::InnerIterator entry(full.matrix, k); entry; ++entry)
          if (kept[entry.row()] >= 0)
            entries.emplace_back(kept[entry.row()], kept[k], entry.value());
    if (n == 1)
      {
        block->inverse = Eigen::MatrixXd::Constant(1, 1, 1 / entries[0].value());
        return block;
      }
    Eigen::SparseMatrix<double> matrix(n, n);
    matrix.setFromTriplets(entries.begin(), entries.end());
    block->factor = std::make_unique<SemidefiniteFactor>(matrix);
    if (n <= largest_dense_block)
      {
        block->inverse = Eigen::MatrixXd::Identity(n, n);
        if (block->factor->n_left_out() == 0)
          block->inverse = Eigen::MatrixXd(matrix).llt().solve(block->inverse).eval();
        else
          for (unsigned int k = 0; k < n; ++k)
            block->inverse.col(k) = block->factor->solve(block->inverse.col(k).eval());
        block->factor.reset();
      }
    return block;
  }

  RowWeights::Inverse::Inverse(const RowWeights &weights, const std::vector<bool> &active)
  {
    for (const auto &full : weights.blocks)
      if (auto block = weights.inverse(full, active))
        blocks.push_back(std::move(block));
  }

  void RowWeights::Inverse::apply(const DistributedVector &x, DistributedVector &y) const
  {
    y = 0;
    Eigen::VectorXd of_block, result;
    for (const auto &block : blocks)
      {
        const auto &rows = block->rows;
        if (rows.size() == 1)
          {
            y.local_element(rows[0]) = block->inverse(0, 0) * x.local_element(rows[0]);
            continue;
          }
        of_block.resize(rows.size());
        for (unsigned int a = 0; a < rows.size(); ++a)
          of_block[a] = x.local_element(rows[a]);
        if (block->factor)
          result = block->factor->solve(of_block);
        else
          result.noalias() = block->inverse * of_block;
        for (unsigned int a = 0; a < rows.size(); ++a)
          y.local_element(rows[a]) = result[a];
      }
  }
} // namespace slipstick::tfeti
