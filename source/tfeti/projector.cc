#include <slipstick/base/numbering.h>
#include <slipstick/tfeti/coarse_solver.h>
#include <slipstick/tfeti/projector.h>

#include <deal.II/base/mpi.h>

#include <boost/serialization/vector.hpp>

namespace slipstick::tfeti
{
  namespace
  {
    /// Column of G at one row, as far as one subdomain makes it.
    struct ColumnPart
    {
      std::uint64_t       row   = 0; // global
      long long           first = 0; // global number of the subdomain's first rigid motion
      std::vector<double> values;

      template <class Archive>
      void serialize(Archive &archive, const unsigned int /*version*/)
      {
        archive &row &first &values;
      }
    };

    /// Columns of tied rows become parts of those that they are tied to.
    void fold(std::vector<ColumnPart> &parts, const std::vector<qp::Tie> &ties, const Partitioner &rows)
    {
      std::map<std::uint64_t, const qp::Tie *> tie_of;
      for (const auto &tie : ties)
        tie_of[rows->local_to_global(tie.tied)] = &tie;
      if (!ties.empty())
        for (ColumnPart &part : parts)
          if (const auto tie = tie_of.find(part.row); tie != tie_of.end())
            {
              part.row = rows->local_to_global(tie->second->to);
              for (double &value : part.values)
                value *= tie->second->factor;
            }
    }

    /// Sums of outer products of the columns of G over the active rows of this rank.
    CoarseSolver::Entries gram_entries(std::vector<ColumnPart> &parts,
                                       const Partitioner       &rows,
                                       const std::vector<bool> &active)
    {
      std::sort(parts.begin(), parts.end(), [](const auto &a, const auto &b) {
        return std::tie(a.row, a.first) < std::tie(b.row, b.first);
      });
      CoarseSolver::Entries entries;
      for (auto begin = parts.begin(); begin != parts.end();)
        {
          const auto end =
            std::find_if(begin, parts.end(), [row = begin->row](const auto &part) { return part.row != row; });
          if (active.empty() || active[rows->global_to_local(begin->row)])
            for (auto a = begin; a != end; ++a)
              for (auto b = begin; b != end; ++b)
                for (unsigned int i = 0; i < a->values.size(); ++i)
                  for (unsigned int j = 0; j < b->values.size(); ++j)
                    entries[{a->first + i, b->first + j}] += a->values[i] * b->values[j];
          begin = end;
        }
      return entries;
    }

    /// G of a subdomain: the rigid motions' share in every row that touches it.
    std::map<unsigned int, Eigen::VectorXd> columns_of(const SubdomainSystem &subdomain, const LocalGluing &gluing)
    {
      std::map<unsigned int, Eigen::VectorXd> columns; // by local row
      for (const auto &entry : gluing.entries)
        {
          const Eigen::VectorXd part =
            entry.value * subdomain.kernel().row(subdomain.touched()[entry.touched]).transpose();
          const auto [position, is_new] = columns.emplace(entry.row, part);
          if (!is_new)
            position->second += part;
        }
      return columns;
    }
  } // namespace

  Projector::Projector(const std::vector<std::unique_ptr<SubdomainSystem>> &subdomains,
                       const std::vector<LocalGluing>                      &gluing,
                       const DualOperator                                  &scatter_gather,
                       const Partitioner                                   &rows,
                       const std::vector<bool>                             &active,
                       const MPI_Comm                                       comm,
                       const std::vector<qp::Tie>                          &ties)
    : scatter_gather(scatter_gather)
    , ties(ties)
    , source(rows)
    , target(rows)
  {
    // is a row active? owners know, ghosts ask
    indicator.reinit(rows);
    for (unsigned int r = 0; r < rows->locally_owned_size(); ++r)
      indicator.local_element(r) = active.empty() || active[r];
    indicator.update_ghost_values();

    for (const auto &subdomain : subdomains)
      n_motions += subdomain->kernel().cols();
    const long long first = first_and_total(n_motions, comm).first;

    std::vector<ColumnPart>                         own;
    std::map<unsigned int, std::vector<ColumnPart>> to_send;
    const auto                                      owner_of_ghost = owners_of_ghosts(rows);

    unsigned int next = 0;
    for (unsigned int p = 0; p < subdomains.size(); ++p)
      {
        const auto columns = columns_of(*subdomains[p], gluing[p]);
        Block      block;
        block.first = next;
        block.values.resize(subdomains[p]->kernel().cols(), columns.size());
        for (const auto &[row, column] : columns)
          {
            ColumnPart part;
            part.row   = rows->local_to_global(row);
            part.first = first + next;
            part.values.assign(column.data(), column.data() + column.size());
            if (row < rows->locally_owned_size())
              own.push_back(std::move(part));
            else
              to_send[owner_of_ghost[row - rows->locally_owned_size()]].push_back(std::move(part));
            block.values.col(block.rows.size()) = column;
            block.rows.push_back(row);
          }
        next += subdomains[p]->kernel().cols();
        blocks.push_back(std::move(block));
      }
    for (auto &[rank, parts] : dealii::Utilities::MPI::some_to_some(comm, to_send))
      std::move(parts.begin(), parts.end(), std::back_inserter(own));
    fold(own, ties, rows);
    coarse = std::make_unique<CoarseSolver>(n_motions, gram_entries(own, rows, active), comm);
  }

  Projector::~Projector() = default;

  Eigen::VectorXd Projector::multiply(const DistributedVector &x) const
  {
    scatter_gather.import(x, source);
    Eigen::VectorXd a = Eigen::VectorXd::Zero(n_motions);
    for (const Block &block : blocks)
      for (unsigned int k = 0; k < block.rows.size(); ++k)
        a.segment(block.first, block.values.rows()) +=
          block.values.col(k) * (indicator.local_element(block.rows[k]) * source.local_element(block.rows[k]));
    return a;
  }

  void Projector::multiply_transpose(const Eigen::VectorXd &a, DistributedVector &y) const
  {
    target.zero_out_ghost_values();
    target = 0;
    for (const Block &block : blocks)
      for (unsigned int k = 0; k < block.rows.size(); ++k)
        target.local_element(block.rows[k]) += block.values.col(k).dot(a.segment(block.first, block.values.rows()));
    target.compress(dealii::VectorOperation::add);
    y.copy_locally_owned_data_from(target);
  }

  void Projector::mask(DistributedVector &y) const
  {
    for (const qp::Tie &tie : ties)
      y.local_element(tie.to) += tie.factor * y.local_element(tie.tied);
    for (const qp::Tie &tie : ties)
      y.local_element(tie.tied) = tie.factor * y.local_element(tie.to);
    for (unsigned int r = 0; r < y.locally_owned_size(); ++r)
      y.local_element(r) *= indicator.local_element(r);
  }

  Eigen::VectorXd Projector::solve(const Eigen::VectorXd &a) const
  {
    return coarse->solve(a);
  }

  Eigen::VectorXd Projector::amplitudes(const DistributedVector &x) const
  {
    return coarse->solve(multiply(x));
  }

  void Projector::project_range(const DistributedVector &x, DistributedVector &y) const
  {
    multiply_transpose(amplitudes(x), y);
    mask(y);
  }

  void Projector::extend_range(const DistributedVector &x, DistributedVector &y) const
  {
    multiply_transpose(amplitudes(x), y);
  }

  void Projector::particular(const Eigen::VectorXd &e, DistributedVector &y) const
  {
    multiply_transpose(coarse->solve(e), y);
    mask(y);
  }

  unsigned long long Projector::dimension() const
  {
    return coarse->dimension();
  }
} // namespace slipstick::tfeti
