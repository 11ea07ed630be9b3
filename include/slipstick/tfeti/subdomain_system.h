// One floating subdomain: its stiffness, a generalised inverse of it, its rigid motions.
#pragma once

#include <slipstick/tfeti/cholesky.h>
#include <slipstick/tfeti/subdomain_matrices.h>

#include <optional>

namespace slipstick::tfeti
{
  /// K, K+ and R of a subdomain with n unknowns.
  ///
  /// K+ = (K + rho N N')^-1, where N picks as many unknowns as there are rigid motions k and N'R is nonsingular. Then
  /// K K+ K = K exactly: K+ K = I - (projection on R along the kernel of N'). The picked unknowns (fixing nodes,
  /// Brzobohaty et al., IJNME 88, 2011) are found from R by pivoting, which spreads them as far as can be; N N' is
  /// diagonal, so the factor fills in no more than that of K.
  class SubdomainSystem
  {
  public:
    /// @param touched unknowns that rows of B touch, sorted; the fixing unknowns are taken from them if they can hold
    ///        the subdomain, else from its boundary.
    /// @param with_trailing_block order the touched and fixing unknowns last, for the dense blocks below.
    /// @throws NumericalError when the kernel of K is not spanned by R.
    SubdomainSystem(const std::shared_ptr<CholmodSession> &session,
                    SubdomainMatrices                      matrices,
                    std::vector<unsigned int>              touched,
                    const bool                             with_trailing_block);

    /// x := K+ x; n entries [N] to [mm].
    void apply_pseudo_inverse(Eigen::VectorXd &x) const;

    /// Keeps no more of the factor than its compact form, with which K+ is applied by conjugate gradients to rounding: a
    /// quarter of the memory. Where most unknowns are touched it would be more, and nothing is done. The dense blocks may
    /// not be asked for afterwards.
    void compress();

    /// K x; n entries [mm] to [N].
    Eigen::VectorXd apply_stiffness(const Eigen::VectorXd &x) const
    {
      return matrices.stiffness.selfadjointView<Eigen::Lower>() * x;
    }

    /// Rows and columns of K+ at the touched unknowns, in their order; packed lower triangle. Needs the trailing block.
    std::vector<double> pseudo_inverse_block() const;

    /// Schur complement of K on the touched unknowns (the fixing ones among them or held together with them), in their
    /// order; packed lower triangle. Needs the trailing block.
    std::vector<double> schur_complement() const;

    /// Rows and columns of K at the touched unknowns, in their order; packed lower triangle.
    std::vector<double> touched_stiffness() const;

    /// Diagonal of K at the touched unknowns.
    Eigen::VectorXd touched_diagonal() const;

    const Eigen::VectorXd &load() const
    {
      return matrices.load;
    }
    /// Another load f_p [N] of the same size.
    void set_load(Eigen::VectorXd load)
    {
      matrices.load = std::move(load);
    }
    const Eigen::MatrixXd &kernel() const
    {
      return matrices.kernel;
    }
    const Eigen::MatrixXd &body_modes() const
    {
      return matrices.body_modes;
    }
    unsigned int body() const
    {
      return matrices.body;
    }
    const BodyFrame &body_frame() const
    {
      return matrices.frame;
    }
    /// Where the node of an unknown lies [mm], as the rotation of the body tells (two dimensions).
    std::array<double, 3> position(const unsigned int unknown) const;
    unsigned int          subdomain() const
    {
      return matrices.subdomain;
    }
    unsigned int n_unknowns() const
    {
      return matrices.load.size();
    }
    const std::vector<unsigned int> &touched() const
    {
      return touched_unknowns;
    }
    /// Memory of the factor [bytes].
    std::size_t factor_bytes() const
    {
      return (compact ? compact->bytes() : 0) + (cholesky ? cholesky->n_nonzeros() * sizeof(double) : 0);
    }

  private:
    std::vector<unsigned int> touched_in_last_order() const;
    Cholesky                  factorised() const;
    bool                      solve_with_compact(Eigen::VectorXd &x) const;

    std::shared_ptr<CholmodSession> session;
    bool                            with_trailing_block;

    SubdomainMatrices         matrices;
    std::vector<unsigned int> touched_unknowns;
    std::vector<unsigned int> fixing_unknowns;
    double                    regularization; // rho [N/mm]

    mutable std::optional<Cholesky> cholesky; // none once compressed, unless single precision does not do
    std::optional<CompactCholesky>  compact;
  };

  /// As many of the @p candidates as R has columns, chosen by pivoting so that the rows of R there are as independent
  /// as can be. @return their list, and the smallest pivot (about 1 when they hold all motions well, 0 when they do not).
  std::pair<std::vector<unsigned int>, double> fixing_unknowns(const Eigen::MatrixXd           &kernel,
                                                               const std::vector<unsigned int> &candidates);
} // namespace slipstick::tfeti
