// Positions of bodies held by contact alone, for given gaps, in which the clipped contact forces balance the loads.
#pragma once

#include <slipstick/qp/admissible_set.h>
#include <slipstick/tfeti/rigid_motions.h>

namespace slipstick::tfeti
{
  /// The motions of bodies which no equality row resists, and the least of
  /// sum_i psi_i(t_i - k_i S_i a) + L'a,   psi_i' = clip to the bounds of row i, over k_i, S_i the jumps of the motions
  /// in row i, L the loads along them: there S'z = L with z = clip(t - k S a), so that the forces z, which a projected
  /// gradient step t = x - k g gives after the motion a, balance the loads up to a part of all forces (only the rest of L
  /// is balanced). Bounds that depend on normal forces follow these. The function is convex and piecewise quadratic;
  /// Newton's method with an exact line search. Tangential forces are intervals: discs are not known here.
  class BodyEquilibrium
  {
  public:
    /// @param bodies is kept by reference. Collective.
    BodyEquilibrium(const BodyMotions &bodies_, const Constraints &constraints, const MPI_Comm comm_);

    /// Are there no such motions?
    bool empty() const
    {
      return motions.empty();
    }

    /// @param of_bodies as BodyMotions::loads() gives them.
    void set_loads(const Eigen::VectorXd &of_bodies);

    /// S a of the owned rows. @param t, k owned rows. @param bounds of them, pressure bounds included. @param tolerated the
    /// part of all forces by which loads may be out of balance. Collective.
    std::vector<double> shift(const std::vector<double>                  &t,
                              const std::vector<double>                  &k,
                              const qp::AdmissibleSet<DistributedVector> &bounds,
                              const double                                tolerated) const;

  private:
    struct Row
    {
      double      t, k, lower, upper;
      int         follows = -1; // the row that its bounds follow
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
    std::vector<unsigned int>                    own;        // owned rows that see the motions
    std::vector<int>                             place_of;   // of owned rows among all that do; -1
    Eigen::SparseMatrix<double, Eigen::RowMajor> shares;     // of all ranks' rows, ordered by their labels ...
    Eigen::SparseMatrix<double>                  by_columns; // ... the same ...
    Eigen::SparseMatrix<double>                  magnitudes; // ... and their absolute values
  };
} // namespace slipstick::tfeti
