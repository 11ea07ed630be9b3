// Sparse Cholesky factorisation (SuiteSparse CHOLMOD, supernodal), whole or ending in a dense trailing block.
#pragma once

#include <Eigen/Dense>
#include <Eigen/Sparse>

#include <cholmod.h>

#include <memory>
#include <vector>

namespace slipstick::tfeti
{
  /// Of the unknowns that are not last.
  enum class Ordering
  {
    minimum_degree,   // AMD, CAMD: quick to find, for small matrices
    nested_dissection // METIS: least fill of large ones in the plane, n log n
  };

  /// CHOLMOD's workspace, shared by the factorisations of a rank, and the analyses of their patterns: matrices with the
  /// same pattern are analysed once.
  class CholmodSession
  {
  public:
    explicit CholmodSession(const Ordering ordering = Ordering::minimum_degree);
    ~CholmodSession();
    CholmodSession(const CholmodSession &)            = delete;
    CholmodSession &operator=(const CholmodSession &) = delete;

    /// Symbolic factor of a matrix with the unknowns `last` ordered last; to be copied, not changed.
    cholmod_factor *analysis(cholmod_sparse &A, const std::vector<unsigned int> &last);

    /// Patterns analysed so far and not forgotten.
    std::size_t n_analyses() const
    {
      return analyses.size();
    }

    /// Frees the analyses. Factors made with them stay.
    void forget_analyses();

    cholmod_common common;

  private:
    cholmod_factor *analyse(cholmod_sparse &A, const std::vector<unsigned int> &last);

    struct Analysis
    {
      std::vector<int>          columns, rows; // compressed columns of the pattern
      std::vector<unsigned int> last;
      cholmod_factor           *factor;
    };
    Ordering              ordering;
    std::vector<Analysis> analyses;
  };

  /// A = L L' of a symmetric positive definite matrix with n unknowns, of which the ones named `last` are ordered last,
  /// so that their part of L is that of the Schur complement of A on them.
  class Cholesky
  {
  public:
    /// For a matrix that turns out not to be positive definite: its description, to follow its name, and the remedy.
    struct Failure
    {
      std::string text, remedy;
    };
    static const Failure of_stiffness; // of a subdomain

    /// @param lower lower triangle of A, compressed columns, sorted.
    /// @throws NumericalError when A is not positive definite; @p name says whose matrix it is.
    Cholesky(const std::shared_ptr<CholmodSession> &session,
             const Eigen::SparseMatrix<double>     &lower,
             const std::vector<unsigned int>       &last,
             const std::string                     &name,
             const Failure                         &failure = of_stiffness);

    /// x := A^-1 x; n entries.
    void solve(Eigen::VectorXd &x) const;

    /// The two halves of solve(): x := L^-1 x with the unknowns in the order of L, the last ones last and as in
    /// `last_order`; then x := L^-T x, in the order of A again.
    void solve_lower(Eigen::VectorXd &x) const;
    void solve_upper(Eigen::VectorXd &x) const;

    /// Dense lower triangular factor of the Schur complement of A on the last unknowns, in the order of `last_order`.
    Eigen::MatrixXd trailing_block() const;

    /// The last unknowns in the order in which the trailing block has them.
    const std::vector<unsigned int> &last_order() const
    {
      return trailing;
    }

    /// Nonzeros of L as stored.
    std::size_t n_nonzeros() const;

  private:
    struct FactorDeleter
    {
      std::shared_ptr<CholmodSession> session;
      void                            operator()(cholmod_factor *factor) const;
    };
    struct DenseDeleter
    {
      std::shared_ptr<CholmodSession> session;
      void                            operator()(cholmod_dense *dense) const;
    };

    /// One of CHOLMOD's systems.
    void solve(const int system, Eigen::VectorXd &x) const;

    std::shared_ptr<CholmodSession>                session;
    std::unique_ptr<cholmod_factor, FactorDeleter> factor;
    std::vector<unsigned int>                      trailing;
  };
} // namespace slipstick::tfeti
