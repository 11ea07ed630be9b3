#include <slipstick/base/exceptions.h>
#include <slipstick/tfeti/coarse_solver.h>

#include <deal.II/base/exceptions.h>

#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wshadow"
#pragma GCC diagnostic ignored "-Wunused-parameter"
#include <Amesos2.hpp>
#include <Teuchos_DefaultMpiComm.hpp>
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

    std::size_t longest_row(const CoarseSolver::Entries &entries)
    {
      std::size_t longest = 0, present = 0;
      long long   row = -1;
      for (const auto &entry : entries)
        {
          present = entry.first.first == row ? present + 1 : 1;
          row     = entry.first.first;
          longest = std::max(longest, present);
        }
      return longest;
    }
  } // namespace

  struct CoarseSolver::Trilinos
  {
    Teuchos::RCP<const Map>   map;
    Teuchos::RCP<Matrix>      matrix;
    Teuchos::RCP<MultiVector> solution, right_hand_side;
    Teuchos::RCP<Solver>      solver;
  };

  CoarseSolver::CoarseSolver(const unsigned int n_owned, const Entries &entries, const MPI_Comm comm)
    : trilinos(std::make_unique<Trilinos>())
  {
    const auto communicator   = Teuchos::rcp(new Teuchos::MpiComm<int>(comm));
    const auto unknown        = Teuchos::OrdinalTraits<Tpetra::global_size_t>::invalid();
    trilinos->map             = Teuchos::rcp(new Map(unknown, n_owned, 0, communicator));
    trilinos->solution        = Teuchos::rcp(new MultiVector(trilinos->map, 1));
    trilinos->right_hand_side = Teuchos::rcp(new MultiVector(trilinos->map, 1));
    if (dimension() == 0)
      return;
    // rows given by several ranks meet in fillComplete, which may lengthen them by what the neighbours know
    trilinos->matrix = Teuchos::rcp(new Matrix(trilinos->map, 2 * longest_row(entries) + 1));
    for (const auto &[position, value] : entries)
      trilinos->matrix->insertGlobalValues(position.first,
                                           Teuchos::tuple<long long>(position.second),
                                           Teuchos::tuple<double>(value));
    trilinos->matrix->fillComplete();
    try
      {
        trilinos->solver =
          Amesos2::create<Matrix, MultiVector>("KLU2", trilinos->matrix, trilinos->solution, trilinos->right_hand_side);
        trilinos->solver->symbolicFactorization().numericFactorization();
      }
    catch (const std::exception &error)
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
      std::copy(b.data(), b.data() + b.size(), view.begin());
    }
    trilinos->solver->solve();
    const auto view = trilinos->solution->getData(0);
    std::copy(view.begin(), view.end(), x.data());
    return x;
  }

  unsigned long long CoarseSolver::dimension() const
  {
    return trilinos->map->getGlobalNumElements();
  }
} // namespace slipstick::tfeti
