// Weights of the rows in the preconditioners of the dual problem.
#pragma once

#include <slipstick/tfeti/dual_operator.h>
#include <slipstick/tfeti/semidefinite_factor.h>

#include <memory>

namespace slipstick::tfeti
{
  /// W = B D^-1 B', D = diag K: couples rows that share nodes, so it consists of blocks, each on one rank: small ones of
  /// single nodes, large sparse ones where mortar rows hang together. Rows may depend on each other.
  class RowWeights
  {
  public:
    /// Collective. @throws NumericalError when rows of one node are owned by different ranks.
    RowWeights(const std::vector<std::unique_ptr<SubdomainSystem>> &subdomains,
               const std::vector<LocalGluing>                      &gluing,
               const Partitioner                                   &rows,
               const MPI_Comm                                       comm);

    /// 1 / W_rr of the owned rows [N/mm]: the force that opens a row, its other rows held, over what it opens by.
    std::vector<double> stiffnesses() const;

    /// Inverse of W restricted to the active rows; of rows that depend on others, a generalised inverse.
    class Inverse
    {
    public:
      Inverse(const RowWeights &weights, const std::vector<bool> &active);

      /// y = W^-1 x on the active rows, 0 on the others; owned entries.
      void apply(const DistributedVector &x, DistributedVector &y) const;

    private:
      friend class RowWeights;
      struct Block
      {
        std::vector<unsigned int>           rows;
        Eigen::MatrixXd                     inverse; // of a small block
        std::unique_ptr<SemidefiniteFactor> factor;  // of a large one
      };
      std::vector<std::shared_ptr<const Block>> blocks;
    };

  private:
    struct Block
    {
      std::vector<unsigned int>             rows; // owned
      Eigen::SparseMatrix<double>           matrix;
      std::shared_ptr<const Inverse::Block> inverse; // with all rows active
    };
    std::shared_ptr<const Inverse::Block> inverse(const Block &full, const std::vector<bool> &active) const;

    std::vector<Block> blocks;
  };
} // namespace slipstick::tfeti
