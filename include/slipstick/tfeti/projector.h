// The coarse problem: G = R'B', its Gram matrix, and the orthogonal projectors Q and P = I - Q.
#pragma once

#include <slipstick/qp/pressure_bounds.h>
#include <slipstick/tfeti/dual_operator.h>

namespace slipstick::tfeti
{
  class CoarseSolver;

  /// Q = G'(G G')^-1 G projects dual vectors on the range of G'. With T from G G' = T^-1 T^-T the rows of T G are
  /// orthonormal; they are never formed, since |T G x| = |Q x|.
  class Projector
  {
  public:
    /// @param active true for the rows (owned by this rank) that take part; the others count as zero columns of G.
    ///        Empty: all rows. G G' must be nonsingular (see rigid_motions.h). Collective.
    /// @param ties owned rows, active too, whose entries are factor times those of another active one: with x = T y of the
    ///        untied entries y, Q is T (G T)'(G T (G T)')^-1 G then (a projector on vectors that obey the ties).
    Projector(const std::vector<std::unique_ptr<SubdomainSystem>> &subdomains,
              const std::vector<LocalGluing>                      &gluing,
              const DualOperator                                  &scatter_gather,
              const Partitioner                                   &rows,
              const std::vector<bool>                             &active,
              const MPI_Comm                                       comm,
              const std::vector<qp::Tie>                          &ties = {});
    ~Projector();

    /// y = Q x, owned entries. Collective.
    void project_range(const DistributedVector &x, DistributedVector &y) const;

    /// As project_range(), but on all rows: y = G'a with the a that makes x - G'a least on the active ones. Collective.
    void extend_range(const DistributedVector &x, DistributedVector &y) const;

    /// G x, the rigid motions of this rank's subdomains in turn; inactive rows count as zero. Collective.
    Eigen::VectorXd multiply(const DistributedVector &x) const;

    /// y = G'(G G')^-1 e: the smallest y with G y = e. e: the rigid motions of this rank's subdomains in turn. Collective.
    void particular(const Eigen::VectorXd &e, DistributedVector &y) const;

    /// (G G')^-1 G x: amplitudes of the rigid motions of this rank's subdomains in turn. Collective.
    Eigen::VectorXd amplitudes(const DistributedVector &x) const;

    /// (G G')^-1 a, on the rigid motions of this rank's subdomains in turn. Collective.
    Eigen::VectorXd solve(const Eigen::VectorXd &a) const;

    /// Number of rigid motions over all ranks.
    unsigned long long dimension() const;

  private:
    /// G of one subdomain: column k of `values` belongs to `rows[k]` (local dual number).
    struct Block
    {
      unsigned int              first; // of its rigid motions among those of this rank
      std::vector<unsigned int> rows;
      Eigen::MatrixXd           values; // motions x rows
    };

    void multiply_transpose(const Eigen::VectorXd &a, DistributedVector &y) const;
    void mask(DistributedVector &y) const;

    const DualOperator           &scatter_gather;
    std::vector<Block>            blocks;
    unsigned int                  n_motions = 0; // of this rank
    std::vector<qp::Tie>          ties;
    std::unique_ptr<CoarseSolver> coarse;
    DistributedVector             indicator; // 1 on active rows, ghosts included
    mutable DistributedVector     source, target;
  };
} // namespace slipstick::tfeti
