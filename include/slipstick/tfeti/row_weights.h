// Weights of the rows in the preconditioners of the dual problem.
#pragma once

#include <slipstick/qp/pressure_bounds.h>
#include <slipstick/tfeti/dual_operator.h>
#include <slipstick/tfeti/semidefinite_factor.h>

#include <functional>
#include <memory>
#include <set>

namespace slipstick::tfeti
{
  /// How c of a row may be changed to make c consistent.
  enum class RowChange
  {
    ignored,   // the row does not count, since it has a compliance
    stays,     // c stays
    forbidden, // c stays, also in rows that depend on this one
    may_change
  };

  /// W = B D^-1 B', D = diag K. It couples rows that share nodes and therefore consists of blocks, each on one rank:
  /// small ones of single nodes, large sparse ones where mortar rows are connected. Rows may be linearly dependent;
  /// a small compliance is added to these before W is inverted.
  class RowWeights
  {
    /// Inverses of blocks of W.
    class InverseBlocks
    {
    public:
      /// @param matrix W of these rows; regularised if it is singular. @return whether it was regular.
      bool add(const std::vector<unsigned int> &rows, Eigen::SparseMatrix<double> &matrix);

      /// A row that shares no unknown with others.
      void add(const unsigned int row, const double weight);

      /// y = W^-1 x on the rows added; the other entries of y are unchanged.
      void apply(const double *x, double *y) const;

    private:
      struct Sparse
      {
        std::vector<unsigned int> rows;
        SemidefiniteFactor        factor;
      };
      std::vector<unsigned int> single_rows;
      std::vector<double>       single_values;
      // dense blocks, stored one after another: number of rows, the rows, n x n entries
      std::vector<unsigned int> sizes, dense_rows;
      std::vector<double>       values;
      std::vector<Sparse>       sparse;
    };

  public:
    /// Collective. @throws NumericalError when rows of one node are owned by different ranks.
    RowWeights(const std::vector<std::unique_ptr<SubdomainSystem>> &subdomains,
               const std::vector<LocalGluing>                      &gluing,
               const Partitioner                                   &rows,
               const MPI_Comm                                       comm);

    /// 1 / W_rr of the owned rows [N/mm]: force over opening of the row, with the other rows held.
    std::vector<double> stiffnesses() const;

    /// For every owned row, whether its multiplier is undetermined: B'x = 0 for some x on the active rows with a
    /// nonzero entry in this row. The result does not depend on the partition.
    std::vector<bool> ambiguous(const std::vector<bool> &active) const;

    /// The smallest change of c after which linear dependences of rows do not exclude displacements u with B u = c:
    /// x'c = 0 for all x with B'x = 0, except those x that involve a row with RowChange::forbidden or for which |x'c|
    /// exceeds @p limit times the largest entry of x. Owned rows.
    std::vector<double> least_correction(const std::vector<double>    &c,
                                         const std::vector<RowChange> &change,
                                         const double                  limit) const;

    /// Inverse of W restricted to the active rows.
    class Inverse
    {
    public:
      /// @param weights are kept by reference.
      /// @param active if there are @p turns: of the turned rows.
      Inverse(const RowWeights &weights, const std::vector<bool> &active, std::vector<qp::Turn> turns = {});

      /// y = W^-1 x on the active rows, 0 on the others; owned entries; x and y are not turned.
      void apply(const DistributedVector &x, DistributedVector &y) const;

    private:
      const RowWeights         &weights;
      std::vector<unsigned int> inactive;
      InverseBlocks             changed; // those with inactive or turned rows
      std::vector<qp::Turn>     turns;
    };

  private:
    struct Block
    {
      std::vector<unsigned int>   rows;     // owned
      Eigen::SparseMatrix<double> matrix;   // W, regularised where rows are linearly dependent
      Eigen::SparseMatrix<double> singular; // W without that; empty if the rows are independent
    };

    /// A basis of the null space of a block of W.
    static Eigen::SparseMatrix<double> null_vectors(const Eigen::SparseMatrix<double> &matrix);

    /// Rows with a share in null vectors of a block of W.
    static std::vector<bool> dependent_rows(const Eigen::SparseMatrix<double> &matrix);

    /// Adds a small compliance to dependent rows, so that the inverse does not resolve forces that do nothing.
    static void regularize(Eigen::SparseMatrix<double> &matrix);

    /// A matrix on the active ones of its rows, and these rows.
    static Block restricted(const std::vector<unsigned int>         &rows,
                            const Eigen::SparseMatrix<double>       &matrix,
                            const std::function<bool(unsigned int)> &is_active);

    /// Disjoint blocks that turns couple, as one block in turned form.
    static Block turned_group(const std::vector<const Block *> &parts, const std::vector<qp::Turn> &turns);

    /// The blocks with turned rows, in turned form; blocks coupled by turns are merged.
    /// @param singles, taken return the numbers of the single rows and of the blocks that were used.
    std::vector<Block> turned(const std::vector<qp::Turn> &turns,
                              std::set<unsigned int>      &singles,
                              std::set<unsigned int>      &taken) const;

    std::vector<unsigned int> single_rows; // nearly all rows: they share no unknown with others
    std::vector<double>       single_weights;
    std::vector<Block>        blocks;
    InverseBlocks             inverse; // with all rows active
  };
} // namespace slipstick::tfeti
