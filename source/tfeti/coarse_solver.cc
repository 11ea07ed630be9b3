#include <slipstick/base/exceptions.h>
#include <slipstick/base/gather.h>
#include <slipstick/tfeti/cholesky.h>
#include <slipstick/tfeti/coarse_solver.h>

#include <deal.II/base/mpi.h>

#include <algorithm>
#include <cmath>
#include <numeric>

namespace slipstick::tfeti
{
  namespace
  {
    // The Schur complement on the changing unknowns is a dense matrix if their number is at most this times the square
    // root of the number of all unknowns (so that it has at most 16 n entries): its factors are then cheaper than
    // sparse ones of the whole matrix.
    constexpr double most_changing = 4;
    // Pivots below this part of their diagonal entry are rounding.
    constexpr double smallest_pivot = 1e-15;

    const std::string       name_of_matrix   = "the coarse matrix G G'";
    const Cholesky::Failure of_coarse_matrix = {" is not positive definite",
                                                "a body is free to move: add a support or a contact that holds it"};

    /// The entries of all ranks on every rank, in the order of the ranks.
    CoarseSolver::Entries gather(const CoarseSolver::Entries &entries, const MPI_Comm comm)
    {
      MPI_Datatype entry;
      MPI_Type_contiguous(sizeof(CoarseSolver::Entry), MPI_BYTE, &entry);
      MPI_Type_commit(&entry);
      std::vector<int> n, first = {0};
      for (const unsigned int n_of_rank :
           all_gather(comm, static_cast<unsigned int>(entries.size())))
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

    /// Lower triangle and diagonal of a symmetric matrix; explicit zeros are kept.
    struct LowerTriangle
    {
      LowerTriangle(const std::size_t n, const CoarseSolver::Entries &entries, const CoarseSolver::Entries &more = {})
        : matrix(n, n)
        , diagonal(Eigen::VectorXd::Zero(n))
      {
        std::vector<Eigen::Triplet<double>> triplets;
        triplets.reserve(entries.size() + more.size());
        for (const auto *part : {&entries, &more})
          for (const auto &entry : *part)
            if (entry.row >= entry.column)
              triplets.emplace_back(entry.row, entry.column, entry.value);
        for (std::size_t i = 0; i < n; ++i)
          triplets.emplace_back(i, i, 0.);
        matrix.setFromTriplets(triplets.begin(), triplets.end());
        for (std::size_t i = 0; i < n; ++i)
          diagonal[i] = matrix.valuePtr()[matrix.outerIndexPtr()[i]]; // the first entry of the sorted column
      }

      /// Replaces A_ij by s_i A_ij s_j with s_i = 1 / sqrt(A_ii + C_ii) where the sum is positive, 1 elsewhere.
      /// @param more C, of which only the diagonal is used.
      /// @return s
      Eigen::VectorXd scale(const CoarseSolver::Entries &more = {})
      {
        Eigen::VectorXd sum = diagonal;
        for (const auto &entry : more)
          if (entry.row == entry.column)
            sum[entry.row] += entry.value;
        const Eigen::VectorXd s = (sum.array() > 0).select(sum.array().rsqrt(), 1.);
        for (Eigen::Index j = 0; j < matrix.cols(); ++j)
          for (Eigen::SparseMatrix<double>::InnerIterator entry(matrix, j); entry; ++entry)
            entry.valueRef() *= s[entry.row()] * s[j];
        return s;
      }

      Eigen::SparseMatrix<double> matrix;
      Eigen::VectorXd             diagonal;
    };
  } // namespace

  /// Factor of one matrix A + C; the same on every rank.
  class CoarseSolver::Factor
  {
  public:
    virtual ~Factor() = default;

    /// x := (A + C)^-1 x, all unknowns.
    virtual void solve(Eigen::VectorXd &x) const = 0;

    virtual std::size_t n_nonzeros() const = 0;
  };

  /// The part shared by the factors of all A + C. The same on every rank.
  class CoarseSolver::Elimination
  {
  public:
    Elimination(const Entries           &own_entries,
                const std::vector<bool> &changes,
                const Entries           &own_changes,
                const MPI_Comm           comm_)
      : comm(comm_)
      , n_owned(changes.size())
      , session(std::make_shared<CholmodSession>(Ordering::nested_dissection))
    {
      std::vector<unsigned int> changing;
      for (const auto &of_rank : all_gather(comm, changes))
        {
          first_of_rank.push_back(n);
          n_of_rank.push_back(static_cast<int>(of_rank.size()));
          for (const bool changes_itself : of_rank)
            {
              if (changes_itself)
                changing.push_back(n);
              ++n;
            }
        }
      Entries all = gather(own_entries, comm);
      if (changing.size() <= most_changing * std::sqrt(n))
        eliminate_all_but(changing, all, gather(own_changes, comm));
      else
        entries = std::move(all);
    }

    std::unique_ptr<const Factor> factor_with(const Entries &own_changes) const;

    Eigen::VectorXd solve(const Eigen::VectorXd &own, const Factor &factor) const
    {
      Eigen::VectorXd x(n);
      MPI_Allgatherv(own.data(),
                     static_cast<int>(n_owned),
                     MPI_DOUBLE,
                     x.data(),
                     n_of_rank.data(),
                     first_of_rank.data(),
                     MPI_DOUBLE,
                     comm);
      if (n > 0)
        factor.solve(x);
      return x.segment(first_of_rank[dealii::Utilities::MPI::this_mpi_process(comm)], n_owned);
    }

    int dimension() const
    {
      return n;
    }

    std::size_t n_nonzeros() const
    {
      return of_staying ? of_staying->n_nonzeros() + L.size() + complement.size() : 0;
    }

  private:
    class WithComplement;
    class Whole;

    /// L L' = s A s + D with the changing unknowns last, where D, 1 there and 0 elsewhere, makes the matrix definite. The
    /// trailing block of L L' minus D is the Schur complement. s belongs to A + C rather than A: A may resist a motion by
    /// rounding only, (1e-16)^2 along an axis to which all normals of its rows are orthogonal, and solutions scaled
    /// by that would lose the digits of the other motions.
    /// @param changes C, the largest one; only its diagonal is used.
    void eliminate_all_but(const std::vector<unsigned int> &changing, const Entries &all, const Entries &changes)
    {
      LowerTriangle A(n, all);
      scale = A.scale(changes);
      for (const unsigned int i : changing)
        A.matrix.coeffRef(i, i) += 1;
      if (n > 0)
        of_staying = std::make_unique<Cholesky>(session, A.matrix, changing, name_of_matrix, of_coarse_matrix);
      session->forget_analyses();
      if (changing.empty())
        return;
      L          = of_staying->trailing_block();
      complement = L.triangularView<Eigen::Lower>() * L.transpose();
      complement.diagonal().array() -= 1;
      place.assign(n, -1);
      diagonal.resize(changing.size());
      for (unsigned int k = 0; k < changing.size(); ++k)
        {
          const unsigned int i = of_staying->last_order()[k];
          place[i]             = static_cast<int>(k);
          diagonal[k]          = A.diagonal[i] * scale[i] * scale[i];
        }
    }

    MPI_Comm                        comm;
    unsigned int                    n_owned;
    int                             n = 0;
    std::vector<int>                first_of_rank, n_of_rank;
    std::shared_ptr<CholmodSession> session;
    Entries                         entries; // without a complement: entries of A

    std::unique_ptr<const Cholesky> of_staying;
    Eigen::VectorXd                 scale;      // s
    std::vector<int>                place;      // among the changing unknowns in the order of L; -1: stays
    Eigen::MatrixXd                 L;          // trailing block: changing unknowns
    Eigen::MatrixXd                 complement; // of s A s
    Eigen::VectorXd                 diagonal;   // of s A s, the changing unknowns
  };

  /// S = Schur complement of s (A + C) s. With y = L^-1 b the changing unknowns are x_c = S^-1 L_c y_c; the others
  /// follow from L' x = y with y_c replaced by L_c'x_c.
  class CoarseSolver::Elimination::WithComplement : public CoarseSolver::Factor
  {
  public:
    WithComplement(const Elimination &common, const Entries &changes)
      : common(common)
    {
      if (common.L.size() == 0)
        return;
      Eigen::MatrixXd S        = common.complement;
      Eigen::VectorXd diagonal = common.diagonal;
      for (const Entry &entry : changes)
        if (entry.row >= entry.column)
          {
            const int    i = common.place[entry.row], j = common.place[entry.column];
            const double value = common.scale[entry.row] * common.scale[entry.column] * entry.value;
            S(std::max(i, j), std::min(i, j)) += value;
            if (i == j)
              diagonal[i] += value;
          }
      inner_scale = (diagonal.array() > 0).select(diagonal.array().rsqrt(), 1.);
      S.array() *= (inner_scale * inner_scale.transpose()).array();
      factor.compute(S);
      if (factor.info() != Eigen::Success || !(pivots().minCoeff() > smallest_pivot))
        throw NumericalError(name_of_matrix + of_coarse_matrix.text, of_coarse_matrix.remedy);
    }

    void solve(Eigen::VectorXd &x) const override
    {
      x.array() *= common.scale.array();
      common.of_staying->solve_lower(x);
      if (common.L.size() > 0)
        {
          auto            changing = x.tail(common.L.cols());
          Eigen::VectorXd y        = common.L.triangularView<Eigen::Lower>() * changing;
          y.array() *= inner_scale.array();
          factor.solveInPlace(y);
          y.array() *= inner_scale.array();
          changing = common.L.transpose().triangularView<Eigen::Upper>() * y;
        }
      common.of_staying->solve_upper(x);
      x.array() *= common.scale.array();
    }

    std::size_t n_nonzeros() const override
    {
      return std::size_t(factor.rows()) * factor.cols(); // 0 before it is computed
    }

  private:
    Eigen::ArrayXd pivots() const
    {
      return factor.matrixLLT().diagonal().array().square();
    }

    const Elimination          &common;
    Eigen::VectorXd             inner_scale;
    Eigen::LLT<Eigen::MatrixXd> factor;
  };

  /// Sparse factor of the whole matrix; the symbolic analysis is that of the first matrix with its pattern.
  class CoarseSolver::Elimination::Whole : public CoarseSolver::Factor
  {
  public:
    Whole(const Elimination &common, LowerTriangle A)
      : scale(A.scale())
      , factor(common.session, A.matrix, {}, name_of_matrix, of_coarse_matrix)
    {}

    void solve(Eigen::VectorXd &x) const override
    {
      x.array() *= scale.array();
      factor.solve(x);
      x.array() *= scale.array();
    }

    std::size_t n_nonzeros() const override
    {
      return factor.n_nonzeros();
    }

  private:
    Eigen::VectorXd scale;
    Cholesky        factor;
  };

  std::unique_ptr<const CoarseSolver::Factor> CoarseSolver::Elimination::factor_with(const Entries &own_changes) const
  {
    const Entries changes = gather(own_changes, comm);
    if (of_staying || n == 0)
      return std::make_unique<WithComplement>(*this, changes);
    return std::make_unique<Whole>(*this, LowerTriangle(n, entries, changes));
  }

  CoarseSolver::CoarseSolver(const unsigned int n_owned, const Entries &entries, const MPI_Comm comm)
    : CoarseSolver(eliminate(entries, std::vector<bool>(n_owned, false), comm), Entries())
  {}

  std::shared_ptr<const CoarseSolver::Elimination> CoarseSolver::eliminate(const Entries           &entries,
                                                                           const std::vector<bool> &changes,
                                                                           const MPI_Comm           comm,
                                                                           const Entries           &largest_changes)
  {
    Entries diagonal;
    std::copy_if(largest_changes.begin(), largest_changes.end(), std::back_inserter(diagonal), [](const Entry &entry) {
      return entry.row == entry.column;
    });
    return std::make_shared<Elimination>(entries, changes, diagonal, comm);
  }

  CoarseSolver::CoarseSolver(std::shared_ptr<const Elimination> staying_, const Entries &changing)
    : staying(std::move(staying_))
    , factor(staying->factor_with(changing))
  {}

  CoarseSolver::~CoarseSolver() = default;

  Eigen::VectorXd CoarseSolver::solve(const Eigen::VectorXd &b) const
  {
    return staying->solve(b, *factor);
  }

  unsigned long long CoarseSolver::dimension() const
  {
    return staying->dimension();
  }

  std::size_t CoarseSolver::n_nonzeros() const
  {
    return staying->n_nonzeros() + factor->n_nonzeros();
  }
} // namespace slipstick::tfeti
