#include <slipstick/base/exceptions.h>
#include <slipstick/tfeti/coarse_solver.h>

#include <deal.II/base/mpi.h>

#include <algorithm>
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

namespace slipstick::tfeti
{
  namespace
  {
    using Map         = Tpetra::Map<int, long long>;
    using Matrix      = Tpetra::CrsMatrix<double, int, long long>;
    using MultiVector = Tpetra::MultiVector<double, int, long long>;
    using Solver      = Amesos2::Solver<Matrix, MultiVector>;

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

  struct CoarseSolver::Trilinos
  {
    Teuchos::RCP<const Map>   map;
    Teuchos::RCP<MultiVector> solution, right_hand_side;
    Teuchos::RCP<Solver>      solver;
  };

  CoarseSolver::CoarseSolver(const unsigned int n_owned_, const Entries &entries, const MPI_Comm comm_)
    : comm(comm_)
    , n_owned(n_owned_)
    , trilinos(std::make_unique<Trilinos>())
  {
    for (const unsigned int n : dealii::Utilities::MPI::all_gather(comm, n_owned))
      {
        first_of_rank.push_back(first_of_rank.empty() ? 0 : first_of_rank.back() + n_of_rank.back());
        n_of_rank.push_back(static_cast<int>(n));
      }
    const auto n              = static_cast<Tpetra::global_size_t>(first_of_rank.back() + n_of_rank.back());
    trilinos->map             = Teuchos::rcp(new Map(n, 0, Teuchos::rcp(new Teuchos::SerialComm<int>())));
    trilinos->solution        = Teuchos::rcp(new MultiVector(trilinos->map, 1));
    trilinos->right_hand_side = Teuchos::rcp(new MultiVector(trilinos->map, 1));
    if (n == 0)
      return;
    try
      {
        trilinos->solver = Amesos2::create<Matrix, MultiVector>("KLU2",
                                                                make_matrix(gather(entries, comm), trilinos->map),
                                                                trilinos->solution,
                                                                trilinos->right_hand_side);
        trilinos->solver->symbolicFactorization().numericFactorization();
      }
    catch (const std::exception &error) // on all ranks alike
      {
        throw NumericalError(std::string("the coarse matrix G G' cannot be factorised: ") + error.what(),
                             "some body is free to move: add a support or a contact that holds it");
      }
  }

  CoarseSolver::~CoarseSolver() = default;

  Eigen::VectorXd CoarseSolver::solve(const Eigen::VectorXd &b) const
  {
    Eigen::VectorXd x(b.size());
    if (dimension() == 0)
      return x;
    {
      auto view = trilinos->right_hand_side->getDataNonConst(0);
      MPI_Allgatherv(b.data(),
                     static_cast<int>(n_owned),
                     MPI_DOUBLE,
                     view.getRawPtr(),
                     n_of_rank.data(),
                     first_of_rank.data(),
                     MPI_DOUBLE,
                     comm);
    }
    trilinos->solver->solve();
    const auto view = trilinos->solution->getData(0);
    int        rank;
    MPI_Comm_rank(comm, &rank);
    std::copy_n(view.begin() + first_of_rank[rank], n_owned, x.data());
    return x;
  }

  unsigned long long CoarseSolver::dimension() const
  {
    return trilinos->map->getGlobalNumElements();
  }
} // namespace slipstick::tfeti
