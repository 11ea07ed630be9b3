// Preconditioners of the dual problem: Dirichlet and lumped, scaled by stiffness.
#pragma once

#include <slipstick/tfeti/dual_operator.h>
#include <slipstick/tfeti/row_weights.h>

namespace slipstick::tfeti
{
  /// M = W^-1 B D^-1 S D^-1 B' W^-1 on a selection of rows. S: Schur complement of K on the touched unknowns
  /// (Dirichlet; Farhat, Mandel, Roux 1994), or K itself there (lumped). D scales by the stiffness of neighbouring
  /// subdomains (Rixen, Farhat 1999).
  class RowPreconditioner
  {
  public:
    /// @param blocks S of this rank's subdomains at their touched unknowns, which must live as long as this; null:
    /// lumped, by products with K.
    RowPreconditioner(const std::vector<std::unique_ptr<SubdomainSystem>> &subdomains,
                      const std::vector<LocalGluing>                      &gluing,
                      const DualOperator                                  &F,
                      const Partitioner                                   &rows,
                      const MPI_Comm                                       comm,
                      const std::vector<PackedSymmetric>                  *blocks);

    const RowWeights &weights() const
    {
      return row_weights;
    }

    /// z = M r [N] of r [mm] on the rows of @p inverse, 0 on the others; owned entries. Collective.
    void apply(const RowWeights::Inverse &inverse, const DistributedVector &r, DistributedVector &z) const;

    /// Summands of r'M r [N mm] at the touched unknowns of every subdomain of this rank. Collective.
    std::vector<Eigen::VectorXd> energies(const RowWeights::Inverse &inverse, const DistributedVector &r) const;

  private:
    /// D^-1 B' W^-1 r: displacements of the touched unknowns of a subdomain. `source` must contain W^-1 r.
    Eigen::VectorXd move(const unsigned int p) const;
    /// Calls f(p, move(p), S or K times that) for every subdomain of this rank.
    template <class F>
    void for_products(const F &f) const;

    const std::vector<std::unique_ptr<SubdomainSystem>> &subdomains;
    const DualOperator                                  &scatter_gather;
    RowWeights                                           row_weights;
    const std::vector<PackedSymmetric>                  *blocks;            // null: lumped
    std::vector<Eigen::VectorXd>                         inverse_diagonals; // of K at the touched unknowns
    mutable DistributedVector                            source, target;    // with ghosts
  };
} // namespace slipstick::tfeti
