#include <slipstick/base/exceptions.h>
#include <slipstick/tfeti/coarse_solver.h>

#include <deal.II/base/mpi.h>

#include <boost/serialization/vector.hpp>

#include <algorithm>
#include <cmath>
#include <numeric>

#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wshadow"
#pragma GCC diagnostic ignored "-Wunused-parameter"
#include <Amesos2.hpp>
#include <Teuchos_DefaultSerialComm.hpp>
#include <Tpetra_CrsMatrix.hpp>
#include <Tpetra_Map.hpp>
#include <Tpetra_MultiVector.hpp>
#pragma GCC diagnostic pop

#include <Eigen/Sparse>

namespace slipstick::tfeti
{
  namespace
  {
    using Map         = Tpetra::Map<int, long long>;
    using Matrix      = Tpetra::CrsMatrix<double, int, long long>;
    using MultiVector = Tpetra::MultiVector<double, int, long long>;
    using Solver      = Amesos2::Solver<Matrix, MultiVector>;

    // Staying unknowns are eliminated when the changing ones are no more than this times the square root of all: then the
    // dense factors of the complement cost less than sparse ones of the whole matrix (2.6 ms at 768 unknowns).
    constexpr double most_changing = 4;

    /// The entries of all ranks on every rank, in the order of the ranks.
    CoarseSolver::Entries gather(const CoarseSolver::Entries &entries, const MPI_Comm comm)
    {
      MPI_Datatype entry;
      MPI_Type_contiguous(sizeof(CoarseSolver::Entry), MPI_BYTE, &entry);
      MPI_Type_commit(&entry);
      std::vector<int> n, first = {0};
      for (const unsigned int n_of_rank :
           dealii::Utilities::MPI::all_gather(comm, static_cast<unsigned int>(entries.size())))
        {
          n.push_back(static_cast<int>(n_of_rank));
          first.push_back(first.back() + n.back());
        }
      CoarseSolver::Entries all(first.back());
      MPI_Allgatherv(entries.data(),
                     static_cast<int>(entries.size()),
                     entry,
                     all.data(),
                     n.data(),
                     first.data(),
                     entry,
                     comm);
      MPI_Type_free(&entry);
      return all;
    }

    /// Compressed rows on one process; entries of one position are added in their order.
    Teuchos::RCP<Matrix> make_matrix(const CoarseSolver::Entries &entries, const Teuchos::RCP<const Map> &map)
    {
      const std::size_t        n = map->getGlobalNumElements();
      std::vector<std::size_t> first(n + 1, 0);
      for (const auto &entry : entries)
        ++first[entry.row + 1];
      std::partial_sum(first.begin(), first.end(), first.begin());
      std::vector<std::size_t>            next(first.begin(), first.end() - 1);
      std::vector<std::pair<int, double>> by_row(entries.size());
      for (const auto &entry : entries)
        by_row[next[entry.row]++] = {static_cast<int>(entry.column), entry.value};

      Teuchos::ArrayRCP<std::size_t> begin(n + 1);
      Teuchos::ArrayRCP<int>         columns(entries.size());
      Teuchos::ArrayRCP<double>      values(entries.size());
      std::size_t                    size = 0;
      begin[0]                            = 0;
      for (std::size_t row = 0; row < n; ++row)
        {
          std::stable_sort(by_row.begin() + first[row],
                           by_row.begin() + first[row + 1],
                           [](const auto &a, const auto &b) { return a.first < b.first; });
          for (std::size_t k = first[row]; k < first[row + 1]; ++k)
            if (size > begin[row] && columns[size - 1] == by_row[k].first)
              values[size - 1] += by_row[k].second;
            else
              {
                columns[size]  = by_row[k].first;
                values[size++] = by_row[k].second;
              }
          begin[row + 1] = size;
        }
      columns.resize(size);
      values.resize(size);
      const auto matrix = Teuchos::rcp(new Matrix(map, map, begin, columns, values));
      matrix->expertStaticFillComplete(map, map);
      return matrix;
    }
  } // namespace

  /// LU factors of a matrix that every rank has, of positions 0 .. n-1.
  class CoarseSolver::Factor
  {
  public:
    Factor(const std::size_t n, const Entries &entries)
      : map(Teuchos::rcp(new Map(n, 0, Teuchos::rcp(new Teuchos::SerialComm<int>()))))
      , solution(Teuchos::rcp(new MultiVector(map, 1)))
      , right_hand_side(Teuchos::rcp(new MultiVector(map, 1)))
    {
      if (n == 0)
        return;
      try
        {
          solver = Amesos2::create<Matrix, MultiVector>("KLU2", make_matrix(entries, map), solution, right_hand_side);
          solver->symbolicFactorization().numericFactorization();
        }
      catch (const std::exception &error) // on all ranks alike
        {
          throw NumericalError(std::string("the coarse matrix G G' cannot be factorised: ") + error.what(),
                               "some body is free to move: add a support or a contact that holds it");
        }
    }

    Eigen::VectorXd solve(const Eigen::VectorXd &b) const
    {
      if (b.size() == 0)
        return b;
      std::copy_n(b.data(), b.size(), right_hand_side->getDataNonConst(0).getRawPtr());
      solver->solve();
      return Eigen::Map<const Eigen::VectorXd>(solution->getData(0).getRawPtr(), b.size());
    }

  private:
    Teuchos::RCP<const Map>   map;
    Teuchos::RCP<MultiVector> solution, right_hand_side;
    Teuchos::RCP<Solver>      solver;
  };

  /// With s the staying and c the changing unknowns: x_c = (A_cc + C - A_cs W)^-1 (b_c - A_cs y), x_s = y - W x_c where
  /// y = A_ss^-1 b_s, W = A_ss^-1 A_sc. The same on every rank.
  class CoarseSolver::Elimination
  {
  public:
    Elimination(const Entries &own_entries, const std::vector<bool> &changes, const MPI_Comm comm_)
      : comm(comm_)
      , n_owned(changes.size())
    {
      const auto  of_ranks = dealii::Utilities::MPI::all_gather(comm, changes);
      std::size_t n_all = 0, n_that_change = 0;
      for (const auto &of_rank : of_ranks)
        {
          n_all += of_rank.size();
          n_that_change += std::count(of_rank.begin(), of_rank.end(), true);
        }
      const bool eliminates = n_that_change <= most_changing * std::sqrt(n_all);
      for (const auto &of_rank : of_ranks)
        {
          first_of_rank.push_back(static_cast<int>(position.size()));
          n_of_rank.push_back(static_cast<int>(of_rank.size()));
          for (const bool changes_itself : of_rank)
            {
              const bool is_changing = changes_itself || !eliminates;
              (is_changing ? changing : staying).push_back(static_cast<int>(position.size()));
              position.push_back(static_cast<int>((is_changing ? changing : staying).size()) - 1);
              changes_at.push_back(is_changing);
            }
        }
      Entries                             inner;
      std::vector<Eigen::Triplet<double>> coupling;
      for (const Entry &entry : gather(own_entries, comm))
        {
          const Entry at{position[entry.row], position[entry.column], entry.value};
          if (!changes_at[entry.row] && !changes_at[entry.column])
            inner.push_back(at);
          else if (changes_at[entry.row] && changes_at[entry.column])
            complement.push_back(at);
          else if (changes_at[entry.row])
            coupling.emplace_back(at.row, at.column, at.value);
        }
      factor = std::make_unique<Factor>(staying.size(), inner);
      A_cs.resize(changing.size(), staying.size());
      A_cs.setFromTriplets(coupling.begin(), coupling.end());
      eliminate_staying();
    }

    /// Entries of C besides, by position among the changing unknowns.
    Entries complement_with(const Entries &own_entries) const
    {
      Entries all = complement;
      for (const Entry &entry : gather(own_entries, comm))
        all.push_back({position[entry.row], position[entry.column], entry.value});
      return all;
    }

    std::size_t n_changing() const
    {
      return changing.size();
    }

    std::size_t n() const
    {
      return position.size();
    }

    Eigen::VectorXd solve(const Eigen::VectorXd &own, const Factor &of_complement) const
    {
      Eigen::VectorXd b(n());
      MPI_Allgatherv(own.data(),
                     static_cast<int>(n_owned),
                     MPI_DOUBLE,
                     b.data(),
                     n_of_rank.data(),
                     first_of_rank.data(),
                     MPI_DOUBLE,
                     comm);
      Eigen::VectorXd x_s = factor->solve(b(staying)), x_c = b(changing);
      if (!changing.empty())
        {
          x_c = of_complement.solve(x_c - A_cs * x_s);
          x_s -= W * x_c;
        }
      int rank;
      MPI_Comm_rank(comm, &rank);
      Eigen::VectorXd x(n_owned);
      for (unsigned int i = 0; i < n_owned; ++i)
        {
          const unsigned int k = first_of_rank[rank] + i;
          x[i]                 = (changes_at[k] ? x_c : x_s)[position[k]];
        }
      return x;
    }

  private:
    // W, and - A_cs W as part of the complement
    void eliminate_staying()
    {
      std::vector<Eigen::Triplet<double>> columns;
      for (unsigned int j = 0; j < changing.size(); ++j)
        {
          const Eigen::VectorXd column = A_cs.row(j).transpose();
          if (column.squaredNorm() == 0)
            continue;
          const Eigen::VectorXd w = factor->solve(column), eliminated = A_cs * w;
          for (unsigned int i = 0; i < w.size(); ++i)
            if (w[i] != 0)
              columns.emplace_back(i, j, w[i]);
          for (unsigned int i = 0; i < eliminated.size(); ++i)
            if (eliminated[i] != 0)
              complement.push_back({i, j, -eliminated[i]});
        }
      W.resize(staying.size(), changing.size());
      W.setFromTriplets(columns.begin(), columns.end());
    }

    MPI_Comm                                     comm;
    unsigned int                                 n_owned;
    std::vector<int>                             first_of_rank, n_of_rank;
    std::vector<int>                             staying, changing;
    std::vector<int>                             position; // among those or these
    std::vector<bool>                            changes_at;
    std::unique_ptr<const Factor>                factor;     // of A_ss
    Entries                                      complement; // A_cc - A_cs W
    Eigen::SparseMatrix<double>                  W;
    Eigen::SparseMatrix<double, Eigen::RowMajor> A_cs;
  };

  CoarseSolver::CoarseSolver(const unsigned int n_owned, const Entries &entries, const MPI_Comm comm)
    : CoarseSolver(eliminate(entries, std::vector<bool>(n_owned, false), comm), Entries())
  {}

  std::shared_ptr<const CoarseSolver::Elimination> CoarseSolver::eliminate(const Entries           &entries,
                                                                           const std::vector<bool> &changes,
                                                                           const MPI_Comm           comm)
  {
    return std::make_shared<Elimination>(entries, changes, comm);
  }

  CoarseSolver::CoarseSolver(std::shared_ptr<const Elimination> staying_, const Entries &changing)
    : staying(std::move(staying_))
    , complement(std::make_unique<Factor>(staying->n_changing(), staying->complement_with(changing)))
  {}

  CoarseSolver::~CoarseSolver() = default;

  Eigen::VectorXd CoarseSolver::solve(const Eigen::VectorXd &b) const
  {
    return staying->solve(b, *complement);
  }

  unsigned long long CoarseSolver::dimension() const
  {
    return staying->n();
  }
} // namespace slipstick::tfeti
