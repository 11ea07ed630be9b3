#include <slipstick/base/numbering.h>
#include <slipstick/tfeti/coarse_solver.h>
#include <slipstick/tfeti/projector.h>

#include <deal.II/base/mpi.h>

#include <boost/serialization/array.hpp>
#include <boost/serialization/vector.hpp>

#include <array>
#include <map>
#include <numeric>
#include <set>
#include <tuple>

namespace slipstick::tfeti
{
  namespace projection // named namespace, since a member of Projector::Motions has a type defined in it
  {
    constexpr unsigned int most_motions = 6; // rigid ones of a solid in space

    /// The contribution of one subdomain to the column of G of one row.
    struct ColumnPart
    {
      std::uint64_t                    row   = 0; // global
      long long                        first = 0; // global number of the subdomain's first rigid motion
      unsigned int                     size  = 0; // of the values: its rigid motions
      std::array<double, most_motions> values{};

      template <class Archive>
      void serialize(Archive &archive, const unsigned int /*version*/)
      {
        archive &row &first &size &values;
      }
    };
  } // namespace projection

  namespace
  {
    using projection::ColumnPart;

    /// Sum of outer products of columns of G, stored as dense blocks: one per pair of subdomains that share a row.
    class Gram
    {
    public:
      /// Adds the column given by its parts (of different subdomains, in ascending order); with weight 0 only its
      /// pattern.
      void add(const ColumnPart *begin, const ColumnPart *end, const double weight)
      {
        for (const ColumnPart *a = begin; a != end; ++a)
          for (const ColumnPart *b = a; b != end; ++b)
            {
              Eigen::MatrixXd &sum = block(*a, *b);
              for (unsigned int j = 0; j < b->size; ++j)
                for (unsigned int i = 0; i < a->size; ++i)
                  sum(i, j) += weight * a->values[i] * b->values[j];
            }
      }

      /// Lower triangle.
      CoarseSolver::Entries entries() const
      {
        CoarseSolver::Entries result;
        for (const auto &[position, sum] : blocks)
          for (unsigned int i = 0; i < sum.rows(); ++i)
            for (unsigned int j = position.first == position.second ? i : 0; j < sum.cols(); ++j)
              result.push_back({position.second + j, position.first + i, sum(i, j)});
        return result;
      }

    private:
      Eigen::MatrixXd &block(const ColumnPart &a, const ColumnPart &b)
      {
        const std::pair<long long, long long> position(a.first, b.first);
        for (const auto &[known, sum] : recent) // consecutive rows mostly belong to the same edge
          if (known == position)
            return *sum;
        auto &sum = blocks[position];
        if (sum.size() == 0)
          sum = Eigen::MatrixXd::Zero(a.size, b.size);
        recent[next++ % recent.size()] = {position, &sum};
        return sum;
      }

      std::map<std::pair<long long, long long>, Eigen::MatrixXd>                   blocks;
      std::array<std::pair<std::pair<long long, long long>, Eigen::MatrixXd *>, 4> recent = {
        {{{-1, -1}, nullptr}, {{-1, -1}, nullptr}, {{-1, -1}, nullptr}, {{-1, -1}, nullptr}}};
      unsigned int next = 0;
    };

    std::vector<ColumnPart> times(const double factor, std::vector<ColumnPart> column)
    {
      for (ColumnPart &part : column)
        for (double &value : part.values)
          value *= factor;
      return column;
    }

    /// Column of a row plus factor times that of a row tied to it.
    std::vector<ColumnPart> sum_of(std::vector<ColumnPart>        column,
                                   const std::vector<ColumnPart> &tied,
                                   const double                   factor)
    {
      for (ColumnPart part : tied)
        {
          for (double &value : part.values)
            value *= factor;
          const auto same =
            std::find_if(column.begin(), column.end(), [&](const auto &other) { return other.first == part.first; });
          if (same == column.end())
            column.push_back(std::move(part));
          else
            for (unsigned int i = 0; i < part.size; ++i)
              same->values[i] += part.values[i];
        }
      std::sort(column.begin(), column.end(), [](const auto &a, const auto &b) { return a.first < b.first; });
      return column;
    }

    /// G of a subdomain: the jumps of the rigid motions in every row that touches it, and those rows (local numbers,
    /// ascending).
    std::pair<std::vector<unsigned int>, Eigen::MatrixXd> columns_of(const SubdomainSystem &subdomain,
                                                                     const LocalGluing     &gluing)
    {
      std::vector<unsigned int> rows;
      for (const auto &entry : gluing.entries)
        rows.push_back(entry.row);
      std::sort(rows.begin(), rows.end());
      rows.erase(std::unique(rows.begin(), rows.end()), rows.end());
      Eigen::MatrixXd columns = Eigen::MatrixXd::Zero(subdomain.kernel().cols(), rows.size());
      for (const auto &entry : gluing.entries)
        columns.col(std::lower_bound(rows.begin(), rows.end(), entry.row) - rows.begin()) +=
          entry.value * subdomain.kernel().row(subdomain.touched()[entry.touched]).transpose();
      return {std::move(rows), std::move(columns)};
    }
  } // namespace

  /// G, by subdomain and by row.
  struct Projector::Motions
  {
    /// G of one subdomain: column k of `values` belongs to `rows[k]` (local dual number).
    struct Block
    {
      unsigned int              first; // of its rigid motions among those of this rank
      std::vector<unsigned int> rows;
      Eigen::MatrixXd           values; // motions x rows

      /// a += G x, x of all rows of this rank and their ghosts.
      void add_product(const double *x, double *a) const
      {
        if (values.rows() == in_the_plane)
          add_product_of<in_the_plane>(x, a);
        else
          add_product_of<Eigen::Dynamic>(x, a);
      }

      /// y += G'a.
      void add_transposed_product(const double *a, double *y) const
      {
        if (values.rows() == in_the_plane)
          add_transposed_product_of<in_the_plane>(a, y);
        else
          add_transposed_product_of<Eigen::Dynamic>(a, y);
      }

    private:
      static constexpr int in_the_plane = 3; // motions, known at compile time: 1.7 times as fast (perf)

      template <int n>
      void add_product_of(const double *x, double *a) const
      {
        Eigen::Matrix<double, n, 1> sum = Eigen::Matrix<double, n, 1>::Zero(values.rows());
        for (unsigned int k = 0; k < rows.size(); ++k)
          sum += Eigen::Map<const Eigen::Matrix<double, n, 1>>(values.col(k).data(), values.rows()) * x[rows[k]];
        Eigen::Map<Eigen::Matrix<double, n, 1>>(a, values.rows()) += sum;
      }

      template <int n>
      void add_transposed_product_of(const double *a, double *y) const
      {
        const Eigen::Matrix<double, n, 1> amplitudes = Eigen::Map<const Eigen::Matrix<double, n, 1>>(a, values.rows());
        for (unsigned int k = 0; k < rows.size(); ++k)
          y[rows[k]] +=
            Eigen::Map<const Eigen::Matrix<double, n, 1>>(values.col(k).data(), values.rows()).dot(amplitudes);
      }
    };

    Motions(const std::vector<std::unique_ptr<SubdomainSystem>> &subdomains,
            const std::vector<LocalGluing>                      &gluing,
            const Partitioner                                   &rows,
            const std::vector<bool>                             &stays,
            const MPI_Comm                                       comm)
    {
      for (const auto &subdomain : subdomains)
        n_motions += subdomain->kernel().cols();
      const long long first = first_and_total(n_motions, comm).first;

      std::map<unsigned int, std::vector<ColumnPart>> to_send;
      const auto                                      owner_of_ghost = owners_of_ghosts(rows);

      unsigned int next = 0;
      for (unsigned int p = 0; p < subdomains.size(); ++p)
        {
          Block block;
          block.first                        = next;
          std::tie(block.rows, block.values) = columns_of(*subdomains[p], gluing[p]);
          for (unsigned int k = 0; k < block.rows.size(); ++k)
            {
              const unsigned int row = block.rows[k];
              ColumnPart         part;
              part.row   = rows->local_to_global(row);
              part.first = first + next;
              part.size  = block.values.rows();
              std::copy_n(block.values.col(k).data(), part.size, part.values.begin());
              (row < rows->locally_owned_size() ? parts : to_send[owner_of_ghost[row - rows->locally_owned_size()]])
                .push_back(part);
            }
          next += subdomains[p]->kernel().cols();
          blocks.push_back(std::move(block));
        }
      for (auto &[rank, sent] : dealii::Utilities::MPI::some_to_some(comm, to_send))
        std::move(sent.begin(), sent.end(), std::back_inserter(parts));
      std::sort(parts.begin(), parts.end(), [](const auto &a, const auto &b) {
        return std::tie(a.row, a.first) < std::tie(b.row, b.first);
      });
      first_part.assign(rows->locally_owned_size() + 1, 0);
      for (const ColumnPart &part : parts)
        ++first_part[rows->global_to_local(part.row) + 1];
      std::partial_sum(first_part.begin(), first_part.end(), first_part.begin());
      for (unsigned int r = 0; r < rows->locally_owned_size(); ++r)
        (stays[r] ? staying : changing).push_back(r);
      find_changing_motions(rows);
    }

    void add(const unsigned int row, const double weight, Gram &gram) const
    {
      gram.add(parts.data() + first_part[row], parts.data() + first_part[row + 1], weight);
    }

    /// Elimination of the staying rows' part of G Theta G'; cached for one metric at a time.
    const std::shared_ptr<const CoarseSolver::Elimination> &staying_part(const std::vector<double> &metric,
                                                                         const MPI_Comm             comm) const
    {
      std::vector<double> of_these; // empty on ranks without rows
      for (const unsigned int r : staying)
        of_these.push_back(metric.empty() ? 1. : metric[r]);
      const bool is_other = !of_staying || metric_of_staying != of_these;
      if (dealii::Utilities::MPI::max(is_other ? 1 : 0, comm) > 0)
        {
          Gram gram;
          for (const unsigned int r : staying)
            add(r, metric.empty() ? 1. : metric[r], gram);
          Gram of_all_changing;
          for (const unsigned int r : changing)
            add(r, metric.empty() ? 1. : metric[r], of_all_changing);
          of_staying        = CoarseSolver::eliminate(gram.entries(), changes, comm, of_all_changing.entries());
          metric_of_staying = std::move(of_these);
        }
      return of_staying;
    }

    std::vector<ColumnPart> column(const unsigned int row) const
    {
      return {parts.begin() + first_part[row], parts.begin() + first_part[row + 1]};
    }

    std::vector<Block>                  blocks;
    unsigned int                        n_motions = 0; // of this rank
    std::vector<projection::ColumnPart> parts;         // of the owned rows, row by row
    std::vector<unsigned int>           first_part;    // of every owned row
    std::vector<unsigned int>           staying, changing;

  private:
    void find_changing_motions(const Partitioner &rows)
    {
      DistributedVector is_changing(rows);
      for (const unsigned int r : changing)
        is_changing.local_element(r) = 1;
      is_changing.update_ghost_values();
      changes.assign(n_motions, false);
      for (const Block &block : blocks)
        if (std::any_of(block.rows.begin(), block.rows.end(), [&](const unsigned int r) {
              return is_changing.begin()[r] != 0;
            }))
          std::fill_n(changes.begin() + block.first, block.values.rows(), true);
    }

    std::vector<bool>                                        changes; // motions of this rank that changing rows resist
    mutable std::shared_ptr<const CoarseSolver::Elimination> of_staying;
    mutable std::vector<double>                              metric_of_staying;
  };

  Projector::Projector(const std::vector<std::unique_ptr<SubdomainSystem>> &subdomains,
                       const std::vector<LocalGluing>                      &gluing,
                       const DualOperator                                  &scatter_gather,
                       const Partitioner                                   &rows,
                       const std::vector<bool>                             &stays,
                       const MPI_Comm                                       comm)
    : scatter_gather(scatter_gather)
    , G(std::make_shared<Motions>(subdomains, gluing, rows, stays, comm))
    , source(rows)
    , target(rows)
  {
    make_coarse({}, comm);
  }

  Projector::Projector(const Projector            &all,
                       const std::vector<bool>    &active,
                       const MPI_Comm              comm,
                       const std::vector<qp::Tie> &ties,
                       const std::vector<double>  &metric,
                       std::vector<qp::Turn>       turns_)
    : scatter_gather(all.scatter_gather)
    , G(all.G)
    , ties(ties)
    , metric(metric)
    , turns(std::move(turns_))
    , has_turns(dealii::Utilities::MPI::max(turns.empty() ? 0 : 1, comm) > 0)
    , source(all.source)
    , target(all.target)
  {
    make_coarse(active, comm);
  }

  void Projector::make_coarse(const std::vector<bool> &active, const MPI_Comm comm)
  {
    // activity of rows: set by their owners, imported by the ghosts
    indicator.reinit(source);
    const unsigned int n = indicator.locally_owned_size();
    for (unsigned int r = 0; r < n; ++r)
      indicator.local_element(r) = active.empty() || active[r];
    indicator.update_ghost_values();

    std::map<unsigned int, std::vector<ColumnPart>>
      other_columns; // of turned rows and of those to which others are tied
    for (const qp::Turn &turn : turns)
      {
        const auto first = G->column(turn.first), second = G->column(turn.second);
        other_columns[turn.first]  = sum_of(times(turn.cosine, first), second, turn.sine);
        other_columns[turn.second] = sum_of(times(turn.cosine, second), first, -turn.sine);
      }
    std::set<unsigned int> tied;
    for (const qp::Tie &tie : ties)
      {
        const auto turned  = other_columns.find(tie.tied);
        const auto of_tied = turned == other_columns.end() ? G->column(tie.tied) : turned->second;
        const auto column  = other_columns.emplace(tie.to, G->column(tie.to)).first;
        column->second     = sum_of(std::move(column->second), of_tied, tie.factor);
        tied.insert(tie.tied);
      }
    Gram gram;
    for (const unsigned int r : G->changing)
      {
        const double weight = indicator.local_element(r) == 0 || tied.count(r) > 0 ? 0.
                              : metric.empty()                                     ? 1.
                                                                                   : metric[r];
        if (const auto column = other_columns.find(r); column != other_columns.end())
          gram.add(column->second.data(), column->second.data() + column->second.size(), weight);
        else
          G->add(r, weight, gram); // zero weights too: all faces share one pattern
      }
    coarse = std::make_unique<CoarseSolver>(G->staying_part(metric, comm), gram.entries());
  }

  Projector::~Projector() = default;

  Eigen::VectorXd Projector::multiply(const DistributedVector &x) const
  {
    if (has_turns) // ghosts may belong to turned rows
      {
        DistributedVector not_turned(x);
        mask(not_turned);
        qp::turn_back(turns, not_turned);
        scatter_gather.import(not_turned, source);
      }
    else
      {
        scatter_gather.import(x, source);
        const unsigned int n_present = source.locally_owned_size() + source.get_partitioner()->n_ghost_indices();
        for (unsigned int r = 0; r < n_present; ++r)
          source.begin()[r] *= indicator.begin()[r];
      }
    Eigen::VectorXd a = Eigen::VectorXd::Zero(G->n_motions);
    for (const auto &block : G->blocks)
      block.add_product(source.begin(), a.data() + block.first);
    return a;
  }

  void Projector::multiply_transpose(const Eigen::VectorXd &a, DistributedVector &y) const
  {
    target.zero_out_ghost_values();
    target = 0;
    for (const auto &block : G->blocks)
      block.add_transposed_product(a.data() + block.first, target.begin());
    target.compress(dealii::VectorOperation::add);
    y.copy_locally_owned_data_from(target);
    qp::turn(turns, y);
  }

  void Projector::mask(DistributedVector &y) const
  {
    for (unsigned int r = 0; r < y.locally_owned_size(); ++r)
      y.local_element(r) *= indicator.local_element(r);
  }

  // y := T Theta T'y on the active rows
  void Projector::spread(DistributedVector &y) const
  {
    for (const qp::Tie &tie : ties)
      y.local_element(tie.to) += tie.factor * y.local_element(tie.tied);
    weigh(y);
    for (const qp::Tie &tie : ties)
      y.local_element(tie.tied) = tie.factor * y.local_element(tie.to);
    mask(y);
  }

  void Projector::weigh(DistributedVector &y) const
  {
    for (unsigned int r = 0; r < metric.size(); ++r)
      y.local_element(r) *= metric[r];
  }

  Eigen::VectorXd Projector::solve(const Eigen::VectorXd &a) const
  {
    return coarse->solve(a);
  }

  Eigen::VectorXd Projector::amplitudes(const DistributedVector &x) const
  {
    if (metric.empty())
      return coarse->solve(multiply(x));
    DistributedVector weighed(x);
    weigh(weighed);
    return coarse->solve(multiply(weighed));
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
    spread(y);
  }

  unsigned long long Projector::dimension() const
  {
    return coarse->dimension();
  }
} // namespace slipstick::tfeti
