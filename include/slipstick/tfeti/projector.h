// The coarse problem: G = R'B', its Gram matrix, and the orthogonal projectors Q and P = I - Q.
#pragma once

#include <slipstick/qp/pressure_bounds.h>
#include <slipstick/tfeti/dual_operator.h>

namespace slipstick::tfeti
{
  class CoarseSolver;

  /// Q = G'(G G')^-1 G projects dual vectors on the range of G'. With T from G G' = T^-1 T^-T the rows of T G are
  /// orthonormal; they are never computed, since |T G x| = |Q x|.
  ///
  /// With a metric Theta (a positive number per row, the inverse of the row's compliance), "smallest" refers to it:
  /// G'(G Theta G')^-1 G Theta projects residuals [mm], Theta G'(G Theta G')^-1 G projects multipliers [N]; each is the
  /// transpose of the other. Corrections are then distributed over stiff and soft bodies according to their stiffnesses (Bhardwaj et
  /// al. 2000; Klawonn, Widlund 2001).
  class Projector
  {
  public:
    /// Projector on all rows.
    /// @param stays owned rows that are active in every restriction; their part of G G' is summed once.
    /// G G' must be nonsingular (see rigid_motions.h). Collective.
    Projector(const std::vector<std::unique_ptr<SubdomainSystem>> &subdomains,
              const std::vector<LocalGluing>                      &gluing,
              const DualOperator                                  &scatter_gather,
              const Partitioner                                   &rows,
              const std::vector<bool>                             &stays,
              const MPI_Comm                                       comm);

    /// Restriction to some of the rows; shares G with @p all.
    /// @param all the projector on all rows.
    /// @param active owned rows that take part; the others count as zero columns of G.
    /// @param ties owned rows, also active, whose entries are a factor times those of another active row: with x = T y
    /// of the untied entries y, Q is T (G T)'(G T (G T)')^-1 G (a projector on vectors that satisfy the ties).
    /// @param metric of the owned rows; empty: 1.
    /// @param turns owned rows that are turned: everything that applies to rows then applies to the turned ones, and
    /// all dual vectors, arguments and results, are turned. Collective.
    Projector(const Projector            &all,
              const std::vector<bool>    &active,
              const MPI_Comm              comm,
              const std::vector<qp::Tie> &ties   = {},
              const std::vector<double>  &metric = {},
              std::vector<qp::Turn>       turns  = {});
    ~Projector();

    /// y = Q x, owned entries; with a metric, the projection of residuals. Not with ties. Collective.
    void project_range(const DistributedVector &x, DistributedVector &y) const;

    /// As project_range(), but on all rows: y = G'a with the a that minimises x - G'a on the active rows. Collective.
    void extend_range(const DistributedVector &x, DistributedVector &y) const;

    /// G x: resultants along the rigid motions of this rank's subdomains, one subdomain after another [N]; inactive rows
    /// count as zero. Collective.
    Eigen::VectorXd multiply(const DistributedVector &x) const;

    /// The smallest y with G y = e, G'(G G')^-1 e without metric and ties. e: along the rigid motions of this rank's
    /// subdomains, one subdomain after another. Collective.
    void particular(const Eigen::VectorXd &e, DistributedVector &y) const;

    /// (G G')^-1 G x: amplitudes of the rigid motions of this rank's subdomains, one after another. Collective.
    Eigen::VectorXd amplitudes(const DistributedVector &x) const;

    /// (G G')^-1 a, on the rigid motions of this rank's subdomains, one after another. Collective.
    Eigen::VectorXd solve(const Eigen::VectorXd &a) const;

    /// Number of rigid motions over all ranks.
    unsigned long long dimension() const;

  private:
    struct Motions; // G

    void make_coarse(const std::vector<bool> &active, const MPI_Comm comm);
    void multiply_transpose(const Eigen::VectorXd &a, DistributedVector &y) const;
    void mask(DistributedVector &y) const;
    void spread(DistributedVector &y) const;
    void weigh(DistributedVector &y) const;

    const DualOperator            &scatter_gather;
    std::shared_ptr<const Motions> G;
    std::vector<qp::Tie>           ties;
    std::vector<double>            metric; // of the owned rows; empty: 1
    std::vector<qp::Turn>          turns;
    bool                           has_turns = false; // on any rank
    std::unique_ptr<CoarseSolver>  coarse;
    DistributedVector              indicator; // 1 on active rows, ghosts included
    mutable DistributedVector      source, target;
  };
} // namespace slipstick::tfeti
