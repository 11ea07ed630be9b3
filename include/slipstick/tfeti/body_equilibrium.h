// Equilibrium positions of bodies held by contact alone: for given gaps, the clipped contact forces balance the
// loads.
#pragma once

#include <slipstick/qp/admissible_set.h>
#include <slipstick/tfeti/rigid_motions.h>

namespace slipstick::tfeti
{
  /// For the rigid motions that no equality row resists: the amplitudes a that minimise
  /// sum_i psi_i(t_i - k_i S_i a) / k_i + L'a,   psi_i' = clip to the bounds of row i,
  /// where S_i are the jumps of the motions in row i and L the loads along the motions. At the minimum S'z = L with z =
  /// clip(t - k S a): the contact forces z after a projected gradient step t = x - k g followed by the motion a are in
  /// equilibrium with the loads, up to a tolerated part of all forces (only the rest of L is balanced). Bounds that
  /// depend on normal forces follow these. The function is convex and piecewise quadratic; it is minimised by Newton's
  /// method with an exact line search. Tangential forces are intervals; discs are not supported.
  class BodyEquilibrium
  {
  public:
    /// @param bodies is kept by reference. Collective.
    BodyEquilibrium(const BodyMotions &bodies_, const Constraints &constraints, const MPI_Comm comm_);

    /// Whether there are no such motions.
    bool empty() const
    {
      return motions.empty();
    }

    /// @param of_bodies loads along the motions of all bodies, as returned by BodyMotions::loads().
    void set_loads(const Eigen::VectorXd &of_bodies);

    /// S a of the owned rows.
    /// @param t, k of the owned rows.
    /// @param bounds of the owned rows, pressure bounds included.
    /// @param tolerated the part of all forces by which loads may remain unbalanced. Collective.
    std::vector<double> shift(const std::vector<double>                  &t,
                              const std::vector<double>                  &k,
                              const qp::AdmissibleSet<DistributedVector> &bounds,
                              const double                                tolerated) const;

  private:
    struct Row
    {
      double      t, k, lower, upper;
      int         follows = -1; // row whose normal force determines the bounds; -1: fixed bounds
      qp::NodeSet forces;       // its admissible forces
    };

    std::vector<Row>       gathered(const std::vector<double>                  &t,
                                    const std::vector<double>                  &k,
                                    const qp::AdmissibleSet<DistributedVector> &bounds) const;
    void                   follow_pressures(const Eigen::VectorXd &a, std::vector<Row> &rows) const;
    Eigen::VectorXd        imbalance(const Eigen::VectorXd       &loads,
                                     std::vector<Row>            &rows,
                                     const Eigen::VectorXd       &a,
                                     double                      &size,
                                     Eigen::SparseMatrix<double> *derivative) const;
    bool                   follow(const Eigen::VectorXd &loads, std::vector<Row> &rows, Eigen::VectorXd &a) const;
    static Eigen::VectorXd clipped(const std::vector<Row> &rows, const Eigen::VectorXd &moved);
    static Eigen::VectorXd stiffness_of(const std::vector<Row> &rows, const Eigen::VectorXd &moved);
    double                 sum_of_magnitudes(const Eigen::VectorXd &loads, const Eigen::VectorXd &forces) const;
    bool   minimise(const Eigen::VectorXd &loads, const std::vector<Row> &rows, Eigen::VectorXd &a) const;
    double line_minimum(const std::vector<Row> &rows,
                        const Eigen::VectorXd  &slips,
                        const Eigen::VectorXd  &along,
                        const double            load) const;

    MPI_Comm                                     comm;
    std::vector<RigidMotion>                     motions;
    Eigen::VectorXd                              all_loads;  // along the motions
    std::vector<unsigned int>                    own;        // owned rows with a jump under some motion
    std::vector<int>                             place_of;   // of owned rows: position in `shares`; -1: none
    Eigen::SparseMatrix<double, Eigen::RowMajor> shares;     // S: rows of all ranks, ordered by their labels ...
    Eigen::SparseMatrix<double>                  by_columns; // ... the same ...
    Eigen::SparseMatrix<double>                  magnitudes; // ... and their absolute values
  };
} // namespace slipstick::tfeti
