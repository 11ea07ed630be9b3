// Sparse Cholesky factorisation (SuiteSparse CHOLMOD, supernodal), of the whole matrix or with a dense trailing
// block.
#pragma once

#include <Eigen/Dense>
#include <Eigen/Sparse>

#include <cholmod.h>

#include <memory>
#include <vector>

namespace slipstick::tfeti
{
  /// Ordering of the unknowns that are not required to come last.
  enum class Ordering
  {
    minimum_degree,   // AMD, CAMD: cheap to compute, for small matrices
    nested_dissection // METIS: least fill for large plane meshes, n log n
  };

  /// CHOLMOD's workspace, shared by the factorisations of a rank, and the analyses of their patterns: matrices with the
  /// same pattern are analysed once, and equal ones share a factor.
  class CholmodSession
  {
  public:
    explicit CholmodSession(const Ordering ordering = Ordering::minimum_degree);
    ~CholmodSession();

    /// X with A X = B for one of the systems that CHOLMOD numbers; valid until the next call.
    /// @throws std::bad_alloc on this rank.
    const double *solve(const int system, cholmod_factor &factor, cholmod_dense &B);

    CholmodSession(const CholmodSession &)            = delete;
    CholmodSession &operator=(const CholmodSession &) = delete;

    /// Symbolic factor of a matrix with the unknowns `last` ordered last. The caller copies it and does not change it.
    cholmod_factor *analysis(cholmod_sparse &A, const std::vector<unsigned int> &last);

    /// A factor of a matrix with this pattern and, up to rounding, the same entries, if one is in use; empty: none.
    std::shared_ptr<cholmod_factor> factor_of(const cholmod_sparse &A, const std::vector<unsigned int> &last) const;

    /// Keeps a factor for factor_of() as long as others use it.
    void keep(const cholmod_sparse                  &A,
              const std::vector<unsigned int>       &last,
              const std::shared_ptr<cholmod_factor> &factor);

    /// Number of analyses in the cache.
    std::size_t n_analyses() const
    {
      return analyses.size();
    }

    /// Frees the cached analyses. Factors made with them stay valid.
    void forget_analyses();

    cholmod_common common;

  private:
    cholmod_factor *analyse(cholmod_sparse &A, const std::vector<unsigned int> &last);

    struct Factorised
    {
      std::vector<double>           entries; // of the matrix
      std::weak_ptr<cholmod_factor> factor;
    };
    struct Analysis
    {
      std::vector<int>          columns, rows; // compressed columns of the pattern
      std::vector<unsigned int> last;
      cholmod_factor           *factor;
      std::vector<Factorised>   factorised = {};
    };
    std::vector<Analysis>::const_iterator find(const cholmod_sparse &A, const std::vector<unsigned int> &last) const;

    Ordering              ordering;
    std::vector<Analysis> analyses;
    cholmod_dense        *X = nullptr, *Y = nullptr, *E = nullptr; // of the last solve
  };

  /// A = L L' of a symmetric positive definite matrix with n unknowns. The unknowns `last` are ordered last, so that
  /// the trailing block of L is the Cholesky factor of the Schur complement of A on them.
  class Cholesky
  {
  public:
    /// Parts of the error message for a matrix that is not positive definite: a description, printed after its name,
    /// and a remedy; and whether the reason is in the input, mesh or materials.
    struct Failure
    {
      std::string text, remedy;
      bool        is_of_input = false;
    };
    static const Failure of_stiffness; // for the stiffness of a subdomain

    /// @param lower lower triangle of A, compressed columns, sorted.
    /// @throws InputError or NumericalError, as @p failure says, when A is not positive definite; @p name identifies the
    /// matrix in the message. std::bad_alloc on this rank, when memory runs out.
    Cholesky(const std::shared_ptr<CholmodSession> &session,
             const Eigen::SparseMatrix<double>     &lower,
             const std::vector<unsigned int>       &last,
             const std::string                     &name,
             const Failure                         &failure = of_stiffness);

    Cholesky(Cholesky &&) = default;
    // It would replace the session before the factor, which is freed by its session.
    Cholesky &operator=(Cholesky &&) = delete;

    /// x := A^-1 x; n entries.
    void solve(Eigen::VectorXd &x) const;

    /// The same for every column: the factor is read once.
    void solve(Eigen::MatrixXd &columns) const;

    /// The same for matrices that share their factor.
    const void *identity() const
    {
      return factor.get();
    }

    /// The two halves of solve(). solve_lower(): x := L^-1 x, the result in the order of L (the last unknowns last, as
    /// in `last_order`). solve_upper(): x := L^-T x, the result in the order of A again.
    void solve_lower(Eigen::VectorXd &x) const;
    void solve_upper(Eigen::VectorXd &x) const;

    /// Dense lower triangular factor of the Schur complement of A on the last unknowns, in the order of `last_order`.
    Eigen::MatrixXd trailing_block() const;

    /// The last unknowns in their order in the trailing block.
    const std::vector<unsigned int> &last_order() const
    {
      return trailing;
    }

    /// Nonzeros of L as stored.
    std::size_t n_nonzeros() const;

  private:
    /// Solves one of the linear systems that CHOLMOD numbers (CHOLMOD_A, CHOLMOD_L, ...) for columns x.
    void solve(const int system, double *x, const std::size_t n_columns) const;

    std::shared_ptr<CholmodSession> session;
    std::shared_ptr<cholmod_factor> factor;
    std::vector<unsigned int>       trailing;
  };
} // namespace slipstick::tfeti
