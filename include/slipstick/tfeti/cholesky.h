// Sparse Cholesky factorisation (SuiteSparse CHOLMOD, supernodal), whole or ending in a dense trailing block.
#pragma once

#include <Eigen/Dense>
#include <Eigen/Sparse>

#include <cholmod.h>

#include <memory>
#include <vector>

namespace slipstick::tfeti
{
  /// CHOLMOD's workspace, shared by the factorisations of a rank, and the analyses of their patterns: matrices of one
  /// pattern are analysed once.
  class CholmodSession
  {
  public:
    CholmodSession();
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
    struct Analysis
    {
      std::vector<int>          columns, rows; // compressed columns of the pattern
      std::vector<unsigned int> last;
      cholmod_factor           *factor;
    };
    std::vector<Analysis> analyses;
  };

  /// A = L L' of a symmetric positive definite matrix with n unknowns, of which the ones named `last` are ordered last,
  /// so that their part of L is that of the Schur complement of A on them.
  class Cholesky
  {
  public:
    /// @param lower lower triangle of A, compressed columns, sorted.
    /// @throws NumericalError when A is not positive definite; @p name says whose matrix it is.
    Cholesky(const std::shared_ptr<CholmodSession> &session,
             const Eigen::SparseMatrix<double>     &lower,
             const std::vector<unsigned int>       &last,
             const std::string                     &name);

    /// x := A^-1 x; n entries.
    void solve(Eigen::VectorXd &x) const;

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

    std::shared_ptr<CholmodSession>                session;
    std::unique_ptr<cholmod_factor, FactorDeleter> factor;
    std::vector<unsigned int>                      trailing;
  };
} // namespace slipstick::tfeti
