#include <slipstick/base/disjoint_sets.h>
#include <slipstick/base/exceptions.h>
#include <slipstick/tfeti/row_weights.h>

#include <deal.II/base/mpi.h>

#include <boost/serialization/vector.hpp>

#include <algorithm>
#include <cstdint>
#include <list>
#include <map>

namespace slipstick::tfeti
{
  namespace
  {
    // Blocks with more rows are factorised as sparse matrices.
    constexpr unsigned int largest_dense_block = 32;
    // Entries of null vectors below this are rounding.
    constexpr double smallest_share = 1e-6;
    // Added to the diagonal entries of dependent rows before W is inverted, relative to these entries.
    constexpr double regularization = 1e-4;

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

    /// One summand with its position among the owned rows.
    struct Entry
    {
      unsigned int row, column;
      double       value;
    };

    /// Summands of W from one subdomain: sums over the unknowns that both rows touch.
    std::vector<Weight> weights_of(const SubdomainSystem &subdomain, const LocalGluing &gluing, const Partitioner &rows)
    {
      using Values = std::vector<std::pair<unsigned int, double>>; // by unknown, or by row (local numbers)
      std::vector<Values>            by_unknown(subdomain.touched().size());
      std::map<unsigned int, Values> by_row;
      for (const auto &entry : gluing.entries)
        by_unknown[entry.touched].emplace_back(entry.row, entry.value);
      for (unsigned int k = 0; k < by_unknown.size(); ++k)
        for (const auto &[row, a] : by_unknown[k])
          by_row[row].emplace_back(k, a);
      const Eigen::VectorXd          diagonal = subdomain.touched_diagonal();
      std::vector<Weight>            weights;
      std::map<unsigned int, double> sums; // of one row, by column
      for (const auto &[row, values] : by_row)
        {
          sums.clear();
          for (const auto &[k, a] : values)
            for (const auto &[column, b] : by_unknown[k])
              sums[column] += a * b / diagonal[k];
          for (const auto &[column, value] : sums)
            weights.push_back({rows->local_to_global(row), rows->local_to_global(column), value});
        }
      return weights;
    }
  } // namespace

  RowWeights::RowWeights(const std::vector<std::unique_ptr<SubdomainSystem>> &subdomains,
                         const std::vector<LocalGluing>                      &gluing,
                         const Partitioner                                   &rows,
                         const MPI_Comm                                       comm)
  {
    std::map<unsigned int, std::vector<Weight>> to_send;
    std::vector<Weight>                         own;
    const auto                                  owners = owners_of_ghosts(rows);
    const unsigned int                          rank   = dealii::Utilities::MPI::this_mpi_process(comm);
    const unsigned int                          n      = rows->locally_owned_size();
    for (unsigned int p = 0; p < subdomains.size(); ++p)
      for (const auto &weight : weights_of(*subdomains[p], gluing[p], rows))
        {
          const unsigned int local = rows->global_to_local(weight.row);
          (local < n ? own : to_send[owners[local - n]]).push_back(weight);
        }
    auto received  = dealii::Utilities::MPI::some_to_some(comm, to_send);
    received[rank] = std::move(own);

    // connected groups of rows, and the entries of W
    std::vector<Entry>        entries;
    DisjointSets              groups(n);
    std::vector<unsigned int> size(n, 0);
    bool                      is_local = true;
    for (const auto &[from, weights] : received)
      for (const auto &weight : weights)
        {
          is_local = is_local && rows->in_local_range(weight.column);
          if (!rows->in_local_range(weight.column))
            continue;
          entries.push_back({rows->global_to_local(weight.row), rows->global_to_local(weight.column), weight.value});
          groups.join(entries.back().row, entries.back().column);
        }
    if (dealii::Utilities::MPI::min(static_cast<int>(is_local), comm) == 0)
      throw NumericalError("rows that share a node are owned by different ranks",
                           "this is a bug of slipstick, please report it");
    for (unsigned int r = 0; r < n; ++r)
      ++size[groups.root(r)];

    constexpr unsigned int    single = -1;
    std::vector<unsigned int> block_of(n, single), position(n); // of the root row of a group; of a row in its block
    std::vector<double>       weight_of_single(n, 0.);
    for (unsigned int r = 0; r < n; ++r)
      if (size[groups.root(r)] == 1)
        single_rows.push_back(r);
      else
        {
          if (groups.root(r) == r)
            {
              block_of[r] = blocks.size();
              blocks.emplace_back();
            }
          auto &of_block = blocks[block_of[groups.root(r)]].rows; // the root is the first row
          position[r]    = of_block.size();
          of_block.push_back(r);
        }
    std::vector<std::vector<Eigen::Triplet<double>>> triplets(blocks.size());
    for (const Entry &entry : entries)
      if (const unsigned int b = block_of[groups.root(entry.row)]; b == single)
        weight_of_single[entry.row] += entry.value;
      else
        triplets[b].emplace_back(position[entry.row], position[entry.column], entry.value);
    for (const unsigned int r : single_rows)
      {
        single_weights.push_back(weight_of_single[r]);
        inverse.add(r, weight_of_single[r]);
      }
    for (unsigned int b = 0; b < blocks.size(); ++b)
      {
        Eigen::SparseMatrix<double> W(blocks[b].rows.size(), blocks[b].rows.size());
        W.setFromTriplets(triplets[b].begin(), triplets[b].end());
        blocks[b].matrix = W;
        if (!inverse.add(blocks[b].rows, blocks[b].matrix))
          blocks[b].singular = W;
      }
  }

  RowWeights::Block RowWeights::restricted(const std::vector<unsigned int>         &rows,
                                           const Eigen::SparseMatrix<double>       &matrix,
                                           const std::function<bool(unsigned int)> &is_active)
  {
    Block            part;
    std::vector<int> place(rows.size(), -1); // positions among the active rows
    for (unsigned int k = 0; k < rows.size(); ++k)
      if (is_active(rows[k]))
        {
          place[k] = part.rows.size();
          part.rows.push_back(rows[k]);
        }
    std::vector<Eigen::Triplet<double>> entries;
    for (unsigned int k = 0; k < rows.size(); ++k)
      if (place[k] >= 0)
        for (Eigen::SparseMatrix<double>::InnerIterator entry(matrix, k); entry; ++entry)
          if (place[entry.row()] >= 0)
            entries.emplace_back(place[entry.row()], place[k], entry.value());
    part.matrix.resize(part.rows.size(), part.rows.size());
    part.matrix.setFromTriplets(entries.begin(), entries.end());
    return part;
  }

  // e_k - W^- W e_k is 0 unless the factorisation skipped row k; the vectors of the skipped rows are a basis of the
  // null space.
  Eigen::SparseMatrix<double> RowWeights::null_vectors(const Eigen::SparseMatrix<double> &matrix)
  {
    const SemidefiniteFactor            factor(matrix);
    const auto                         &skipped = factor.left_out();
    std::vector<Eigen::Triplet<double>> entries;
    for (unsigned int k = 0; k < skipped.size(); ++k)
      {
        Eigen::VectorXd share = -factor.solve(matrix.col(skipped[k]));
        share[skipped[k]] += 1;
        for (unsigned int r = 0; r < share.size(); ++r)
          if (std::abs(share[r]) > smallest_share)
            entries.emplace_back(r, k, share[r]);
      }
    Eigen::SparseMatrix<double> result(matrix.rows(), skipped.size());
    result.setFromTriplets(entries.begin(), entries.end());
    return result;
  }

  std::vector<bool> RowWeights::dependent_rows(const Eigen::SparseMatrix<double> &matrix)
  {
    std::vector<bool>                 result(matrix.rows(), false);
    const Eigen::SparseMatrix<double> null = null_vectors(matrix);
    for (unsigned int k = 0; k < null.cols(); ++k)
      for (Eigen::SparseMatrix<double>::InnerIterator entry(null, k); entry; ++entry)
        result[entry.row()] = true;
    return result;
  }

  void RowWeights::regularize(Eigen::SparseMatrix<double> &matrix)
  {
    const auto dependent = dependent_rows(matrix);
    for (unsigned int r = 0; r < dependent.size(); ++r)
      if (dependent[r])
        matrix.coeffRef(r, r) *= 1 + regularization;
  }

  std::vector<bool> RowWeights::ambiguous(const std::vector<bool> &active) const
  {
    std::vector<bool> result(active.size(), false);
    for (const auto &full : blocks)
      {
        if (full.singular.size() == 0) // then every principal submatrix is regular
          continue;
        const Block part =
          restricted(full.rows, full.singular, [&active](const unsigned int row) { return active[row]; });
        if (part.rows.empty())
          continue;
        const auto dependent = dependent_rows(part.matrix);
        for (unsigned int r = 0; r < dependent.size(); ++r)
          result[part.rows[r]] = dependent[r];
      }
    return result;
  }

  std::vector<double> RowWeights::least_correction(const std::vector<double>    &c,
                                                   const std::vector<RowChange> &change,
                                                   const double                  limit) const
  {
    std::vector<double> result(c.size(), 0.);
    for (const auto &full : blocks)
      {
        if (full.singular.size() == 0)
          continue;
        const Block part = restricted(full.rows, full.singular, [&change](const unsigned int row) {
          return change[row] != RowChange::ignored;
        });
        if (part.rows.empty())
          continue;
        const auto      null = null_vectors(part.matrix);
        Eigen::VectorXd of_block(part.rows.size()), changes(part.rows.size());
        for (unsigned int r = 0; r < part.rows.size(); ++r)
          {
            of_block[r] = c[part.rows[r]];
            changes[r]  = change[part.rows[r]] == RowChange::may_change ? 1. : 0.;
          }
        Eigen::VectorXd by = null.transpose() * of_block; // contradictions
        for (unsigned int k = 0; k < null.cols(); ++k)
          {
            bool   may_change = true;
            double largest    = 0; // share in x
            for (Eigen::SparseMatrix<double>::InnerIterator entry(null, k); entry; ++entry)
              {
                may_change = may_change && change[part.rows[entry.row()]] != RowChange::forbidden;
                largest    = std::max(largest, std::abs(entry.value()));
              }
            may_change = may_change && std::abs(by[k]) <= limit * largest;
            by[k]      = may_change ? by[k] : 0.;
          }
        if (by.isZero(0.))
          continue;
        const Eigen::SparseMatrix<double> on_these = changes.asDiagonal() * null;
        const Eigen::VectorXd least = on_these * SemidefiniteFactor((on_these.transpose() * on_these).eval()).solve(by);
        for (unsigned int r = 0; r < part.rows.size(); ++r)
          result[part.rows[r]] = -least[r];
      }
    return result;
  }

  std::vector<double> RowWeights::stiffnesses() const
  {
    std::size_t n = single_rows.size();
    for (const auto &block : blocks)
      n += block.rows.size();
    std::vector<double> result(n);
    for (unsigned int k = 0; k < single_rows.size(); ++k)
      result[single_rows[k]] = 1 / single_weights[k];
    for (const auto &block : blocks)
      for (unsigned int k = 0; k < block.rows.size(); ++k)
        result[block.rows[k]] = 1 / (block.singular.size() == 0 ? block.matrix : block.singular).coeff(k, k);
    return result;
  }

  void RowWeights::InverseBlocks::add(const unsigned int row, const double weight)
  {
    single_rows.push_back(row);
    single_values.push_back(1 / weight);
  }

  bool RowWeights::InverseBlocks::add(const std::vector<unsigned int> &rows, Eigen::SparseMatrix<double> &matrix)
  {
    const unsigned int n = rows.size();
    if (n == 1)
      {
        add(rows[0], matrix.coeff(0, 0));
        return true;
      }
    SemidefiniteFactor factor(matrix);
    const bool         is_regular = factor.left_out().empty();
    if (!is_regular)
      {
        regularize(matrix);
        factor = SemidefiniteFactor(matrix);
      }
    if (n > largest_dense_block)
      {
        sparse.push_back({rows, std::move(factor)});
        return is_regular;
      }
    Eigen::MatrixXd inverse = Eigen::MatrixXd::Identity(n, n);
    if (is_regular)
      inverse = Eigen::MatrixXd(matrix).llt().solve(inverse).eval();
    else
      for (unsigned int k = 0; k < n; ++k)
        inverse.col(k) = factor.solve(inverse.col(k).eval());
    sizes.push_back(n);
    dense_rows.insert(dense_rows.end(), rows.begin(), rows.end());
    values.insert(values.end(), inverse.data(), inverse.data() + n * n);
    return is_regular;
  }

  void RowWeights::InverseBlocks::apply(const double *x, double *y) const
  {
    for (unsigned int k = 0; k < single_rows.size(); ++k)
      y[single_rows[k]] = single_values[k] * x[single_rows[k]];
    const unsigned int *rows  = dense_rows.data();
    const double       *value = values.data();
    for (const unsigned int n : sizes)
      {
        if (n == 2) // the two directions of a node
          {
            const double x0 = x[rows[0]], x1 = x[rows[1]];
            y[rows[0]] = value[0] * x0 + value[2] * x1;
            y[rows[1]] = value[1] * x0 + value[3] * x1;
          }
        else
          for (unsigned int i = 0; i < n; ++i)
            {
              double sum = 0;
              for (unsigned int j = 0; j < n; ++j)
                sum += value[i + j * n] * x[rows[j]];
              y[rows[i]] = sum;
            }
        rows += n;
        value += n * n;
      }
    Eigen::VectorXd of_block;
    for (const auto &block : sparse)
      {
        of_block.resize(block.rows.size());
        for (unsigned int a = 0; a < block.rows.size(); ++a)
          of_block[a] = x[block.rows[a]];
        of_block = block.factor.solve(of_block);
        for (unsigned int a = 0; a < block.rows.size(); ++a)
          y[block.rows[a]] = of_block[a];
      }
  }

  RowWeights::Block RowWeights::turned_group(const std::vector<const Block *> &parts,
                                             const std::vector<qp::Turn>      &turns)
  {
    Block                               group;
    std::map<std::size_t, unsigned int> position; // by row
    std::vector<Eigen::Triplet<double>> of_W, of_Q;
    for (const Block *part : parts)
      {
        const unsigned int first = group.rows.size();
        for (unsigned int k = 0; k < part->rows.size(); ++k)
          {
            position[part->rows[k]] = first + k;
            group.rows.push_back(part->rows[k]);
            for (Eigen::SparseMatrix<double>::InnerIterator entry(part->matrix, k); entry; ++entry)
              of_W.emplace_back(first + entry.row(), first + k, entry.value());
          }
      }
    std::vector<double> diagonal(group.rows.size(), 1.);
    for (const qp::Turn &turn : turns)
      {
        const unsigned int first = position.at(turn.first), second = position.at(turn.second);
        diagonal[first] = diagonal[second] = turn.cosine;
        of_Q.emplace_back(first, second, turn.sine);
        of_Q.emplace_back(second, first, -turn.sine);
      }
    for (unsigned int k = 0; k < diagonal.size(); ++k)
      of_Q.emplace_back(k, k, diagonal[k]);
    Eigen::SparseMatrix<double> W(group.rows.size(), group.rows.size()), Q(W.rows(), W.cols());
    W.setFromTriplets(of_W.begin(), of_W.end());
    Q.setFromTriplets(of_Q.begin(), of_Q.end());
    group.matrix = (Q * W * Q.transpose()).eval();
    return group;
  }

  std::vector<RowWeights::Block> RowWeights::turned(const std::vector<qp::Turn> &turns,
                                                    std::set<unsigned int>      &singles,
                                                    std::set<unsigned int>      &taken) const
  {
    std::set<unsigned int> rows;
    for (const qp::Turn &turn : turns)
      rows.insert({static_cast<unsigned int>(turn.first), static_cast<unsigned int>(turn.second)});
    std::vector<const Block *>          parts;   // with these rows
    std::map<std::size_t, unsigned int> part_of; // by row
    const auto                          add = [&](const Block &part) {
      for (const unsigned int row : part.rows)
        part_of[row] = parts.size();
      parts.push_back(&part);
    };
    for (unsigned int b = 0; b < blocks.size(); ++b)
      if (std::any_of(blocks[b].rows.begin(), blocks[b].rows.end(), [&](const auto row) {
            return rows.count(row) > 0;
          }))
        {
          add(blocks[b]);
          taken.insert(b);
        }
    std::list<Block> of_singles;
    for (unsigned int k = 0; k < single_rows.size(); ++k)
      if (rows.count(single_rows[k]) > 0)
        {
          Block single;
          single.rows = {single_rows[k]};
          single.matrix.resize(1, 1);
          single.matrix.insert(0, 0) = single_weights[k];
          of_singles.push_back(std::move(single));
          add(of_singles.back());
          singles.insert(k);
        }

    DisjointSets                          groups(parts.size());
    std::vector<std::list<const Block *>> parts_of(parts.size()); // by root of the group, those of first rows first
    std::vector<std::vector<qp::Turn>>    turns_of(parts.size()); // by root
    for (unsigned int p = 0; p < parts.size(); ++p)
      parts_of[p] = {parts[p]};
    for (const qp::Turn &turn : turns)
      if (const unsigned int a = groups.root(part_of.at(turn.first)), b = groups.root(part_of.at(turn.second)); a != b)
        {
          groups.join(a, b);
          parts_of[a].splice(parts_of[a].end(), parts_of[b]);
          if (groups.root(a) == b)
            std::swap(parts_of[a], parts_of[b]);
        }
    for (const qp::Turn &turn : turns)
      turns_of[groups.root(part_of.at(turn.first))].push_back(turn);
    std::vector<Block> result;
    for (unsigned int g = 0; g < parts.size(); ++g)
      if (!parts_of[g].empty())
        result.push_back(turned_group({parts_of[g].begin(), parts_of[g].end()}, turns_of[g]));
    return result;
  }

  RowWeights::Inverse::Inverse(const RowWeights        &weights_,
                               const std::vector<bool> &active,
                               std::vector<qp::Turn>    turns_)
    : weights(weights_)
    , turns(std::move(turns_))
  {
    const auto is_active = [&active](const unsigned int row) { return active.empty() || active[row]; };
    const auto change    = [&](const Block &full) {
      for (const unsigned int row : full.rows)
        if (!is_active(row))
          inactive.push_back(row);
      Block part = restricted(full.rows, full.matrix, is_active);
      if (!part.rows.empty())
        changed.add(part.rows, part.matrix);
    };
    std::set<unsigned int> turned_singles, turned_blocks;
    if (!turns.empty())
      for (const Block &block : weights.turned(turns, turned_singles, turned_blocks))
        change(block);
    for (unsigned int k = 0; k < weights.single_rows.size(); ++k)
      if (!is_active(weights.single_rows[k]) && turned_singles.count(k) == 0)
        inactive.push_back(weights.single_rows[k]);
    for (unsigned int b = 0; b < weights.blocks.size(); ++b)
      if (turned_blocks.count(b) == 0 &&
          !std::all_of(weights.blocks[b].rows.begin(), weights.blocks[b].rows.end(), is_active))
        change(weights.blocks[b]);
  }

  void RowWeights::Inverse::apply(const DistributedVector &x, DistributedVector &y) const
  {
    weights.inverse.apply(x.begin(), y.begin());
    for (const unsigned int row : inactive)
      y.local_element(row) = 0;
    if (turns.empty())
      {
        changed.apply(x.begin(), y.begin());
        return;
      }
    DistributedVector at(x);
    qp::turn(turns, at);
    changed.apply(at.begin(), y.begin());
    qp::turn_back(turns, y);
  }
} // namespace slipstick::tfeti
