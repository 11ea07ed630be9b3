#include <slipstick/base/exceptions.h>
#include <slipstick/tfeti/coarse_solver.h>

#include <deal.II/base/mpi.h>

#include <boost/serialization/utility.hpp>
#include <boost/serialization/vector.hpp>

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
    using Entry       = std::pair<std::pair<long long, long long>, double>;
    using Map         = Tpetra::Map<int, long long>;
    using Matrix      = Tpetra::CrsMatrix<double, int, long long>;
    using MultiVector = Tpetra::MultiVector<double, int, long long>;
    using Solver      = Amesos2::Solver<Matrix, MultiVector>;

    /// The entries of all ranks on every rank, those of one position added in the order of the ranks.
    CoarseSolver::Entries gather(const CoarseSolver::Entries &entries, const MPI_Comm comm)
    {
      CoarseSolver::Entries sum;
      for (const auto &part :
           dealii::Utilities::MPI::all_gather(comm, std::vector<Entry>(entries.begin(), entries.end())))
        for (const auto &[position, value] : part)
          sum[position] += value;
      return sum;
    }

    /// Compressed rows on one process.
    Teuchos::RCP<Matrix> make_matrix(const CoarseSolver::Entries &entries, const Teuchos::RCP<const Map> &map)
    {
      Teuchos::Array<std::size_t> row_lengths(map->getGlobalNumElements(), 0);
      for (const auto &entry : entries)
        ++row_lengths[entry.first.first];
      const auto matrix = Teuchos::rcp(new Matrix(map, row_lengths()));
      for (const auto &[position, value] : entries)
        matrix->insertGlobalValues(position.first,
                                   Teuchos::tuple<long long>(position.second),
                                   Teuchos::tuple<double>(value));
      matrix->fillComplete();
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
