// One floating subdomain: stiffness, generalised inverse, rigid motions.
#pragma once

#include <slipstick/tfeti/cholesky.h>
#include <slipstick/tfeti/packed.h>
#include <slipstick/tfeti/subdomain_matrices.h>

#include <optional>

namespace slipstick::tfeti
{
  /// K, K+ and R of a subdomain with n unknowns.
  ///
  /// K+ = (K + rho N N')^-1, where N picks as many unknowns as there are rigid motions k and N'R is nonsingular. Then K
  /// K+ K = K exactly: K+ K = I - (projection on R along the kernel of N'). The picked unknowns (fixing nodes,
  /// Brzobohaty et al., IJNME 88, 2011) are found from R by pivoting, which spreads them as far as possible; N N' is
  /// diagonal, so the factor has no more fill than that of K.
  class SubdomainSystem
  {
  public:
    /// @param touched unknowns touched by rows of B, sorted; the fixing unknowns are taken from them if they can hold
    /// the subdomain, otherwise from its boundary.
    /// @param with_trailing_block order the touched and fixing unknowns last, for the dense blocks below.
    /// @param fixed_at_boundary take the fixing unknowns from the boundary in any case: congruent subdomains then have
    /// the same ones and share their factor.
    /// @throws InputError when the kernel of K is not spanned by R.
    SubdomainSystem(const std::shared_ptr<CholmodSession> &session,
                    SubdomainMatrices                      matrices,
                    std::vector<unsigned int>              touched,
                    const bool                             with_trailing_block,
                    const bool                             fixed_at_boundary = false);

    /// x := K+ x; n entries [N] to [mm].
    void apply_pseudo_inverse(Eigen::VectorXd &x) const;

    /// The same for the columns of subdomains with the same factor().
    void apply_pseudo_inverse(Eigen::MatrixXd &columns) const;

    /// Identity of the factor of K+, which congruent subdomains share; null: none.
    const void *factor() const
    {
      return cholesky ? cholesky->identity() : nullptr;
    }

    bool has_factor() const
    {
      return cholesky.has_value();
    }

    /// Moves K, f and R out, for a factor in another order. The object must not be used afterwards.
    SubdomainMatrices take_matrices()
    {
      return std::move(matrices);
    }

    /// Frees the factor. K+ is then applied by a new factorisation every time, in an order with less fill; the dense
    /// blocks are no longer available.
    void release()
    {
      cholesky.reset();
    }

    /// Diagonal of K [N/mm].
    Eigen::VectorXd stiffness_diagonal() const
    {
      return matrices.stiffness.diagonal();
    }

    /// K x; n entries [mm] to [N].
    Eigen::VectorXd apply_stiffness(const Eigen::VectorXd &x) const
    {
      return matrices.stiffness.selfadjointView<Eigen::Lower>() * x;
    }

    /// Forces at the touched unknowns [N] when they move by @p x [mm] and the others do not.
    Eigen::VectorXd apply_touched_stiffness(const Eigen::VectorXd &x) const;

    /// Rows and columns of K+ at the touched unknowns, in their order. Needs the trailing block.
    PackedSymmetric pseudo_inverse_block(const Precision precision) const;

    /// Schur complement of K on the touched unknowns (the fixing unknowns are among them or held together with them),
    /// in their order. Needs the trailing block. In subdomains that are far softer in one deformation than in another
    /// (strips) it is stored in double precision in any case, since single precision would lose the soft deformation.
    PackedSymmetric schur_complement(const Precision precision) const;

    /// Computes the factor for apply_schur_complements(): of K at the unknowns that rows do not touch.
    void prepare_schur_complement(const std::shared_ptr<CholmodSession> &session);

    bool has_schur_complement() const
    {
      return inner.has_value();
    }

    /// Identity of that factor; null: none.
    const void *inner_factor() const
    {
      return inner ? inner->identity() : nullptr;
    }

    /// Products of the Schur complements of K on the touched unknowns with x, in their order, without forming the
    /// matrices, for subdomains with the same inner_factor(). @param x by subdomain; replaced by the products.
    static void apply_schur_complements(const std::vector<const SubdomainSystem *> &subdomains,
                                        std::vector<Eigen::VectorXd>               &x);

    /// Whether there are so many touched unknowns that their dense blocks would have far more entries than K.
    static bool prefers_factors(const SubdomainMatrices &matrices, const std::size_t n_touched);

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
    /// Volumes at the nodes, for every unknown [mm^3]; 1 if they are not known.
    Eigen::VectorXd volumes() const;
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
    /// Position of the node of an unknown [mm].
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
      return cholesky ? cholesky->n_nonzeros() * sizeof(double) : 0;
    }

  private:
    std::vector<unsigned int> touched_in_last_order() const;
    Cholesky                  factorised(const std::vector<unsigned int> &last) const;

    std::shared_ptr<CholmodSession> session;
    SubdomainMatrices               matrices;
    std::vector<unsigned int>       touched_unknowns;
    std::vector<unsigned int>       fixing_unknowns;
    double                          regularization; // rho [N/mm]
    bool                            is_soft;        // far softer in some deformation than the largest entry of K
    std::optional<Cholesky>         cholesky;       // empty after release()
    std::optional<Cholesky>         inner;          // of K at the unknowns that are not touched
    Eigen::SparseMatrix<double>     inner_touched;  // K between these and the touched ones
    Eigen::SparseMatrix<double>     touched_part;   // lower triangle of K at the touched unknowns
  };

  /// As many of the @p candidates as R has columns, chosen by pivoting so that the rows of R are as independent as
  /// possible; of candidates whose squared pivots differ by no more than the part @p equal, the first.
  /// @return the unknowns, and the smallest pivot (about 1 if they hold all motions well, 0 if they do not).
  std::pair<std::vector<unsigned int>, double> fixing_unknowns(const Eigen::MatrixXd           &kernel,
                                                               const std::vector<unsigned int> &candidates,
                                                               const double                     equal = 0);
} // namespace slipstick::tfeti
