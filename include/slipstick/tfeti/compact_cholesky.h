// A Cholesky factor in a quarter of the memory, for what is solved rarely.
#pragma once

#include <Eigen/Dense>
#include <Eigen/Sparse>

#include <cholmod.h>

#include <vector>

namespace slipstick::tfeti
{
  /// The supernodal factor L of a matrix A = [A_ii A_ib; A_bi A_bb] (b: the trailing unknowns) in single precision and
  /// without its part L_bi, which L_ii and A_bi replace. Solves A approximately: a preconditioner for A.
  class CompactCholesky
  {
  public:
    CompactCholesky(const cholmod_factor &factor, const unsigned int n_trailing);

    /// z = M r, about A^-1 r; M is symmetric positive definite. @p lower: lower triangle of A (the block A_bb is not
    /// used). z holds infinities or NaN when single precision does not do.
    void apply(const Eigen::SparseMatrix<double> &lower, const Eigen::VectorXd &r, Eigen::VectorXd &z) const;

    std::size_t bytes() const;

  private:
    // Columns first ... first + n_columns of L_ii, dense, with n_rows rows, the triangle first.
    struct Supernode
    {
      int         first, n_columns, n_rows;
      std::size_t rows, values; // where they start
    };

    int n_interior() const
    {
      return static_cast<int>(order.size()) - n_trailing;
    }
    void solve_interior(Eigen::VectorXf &x) const;
    void solve_trailing(Eigen::VectorXf &x) const;

    int                    n_trailing;
    std::vector<int>       order; // order[k]: the unknown that is eliminated as the k-th
    std::vector<Supernode> supernodes;
    std::vector<int>       rows; // of the supernodes below their triangles
    std::vector<float>     values;
    std::vector<float>     trailing;    // L_bb, packed lower triangle
    int                    longest = 0; // rows of a supernode below its triangle
  };
} // namespace slipstick::tfeti
