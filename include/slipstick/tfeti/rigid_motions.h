// Rigid motions of whole bodies: detection of free motions, and their names.
#pragma once

#include <slipstick/base/exceptions.h>
#include <slipstick/qp/pressure_bounds.h>
#include <slipstick/tfeti/dual_operator.h>

#include <Eigen/SparseCore>

namespace slipstick::tfeti
{
  /// A rigid motion of one or more bodies: amplitudes of the motions of every body, in the plane translation x,
  /// translation y and rotation, in space three translations and three rotations, of bodies of revolution the
  /// translation along the axis.
  struct RigidMotion
  {
    Eigen::VectorXd        amplitudes; // per body as many as it has motions; unit length
    double                 work = 0;   // of the loads along it, over |loads| [-]
    std::vector<BodyFrame> frames;     // of the bodies
    double                 load = 0;   // along it [N]
  };

  /// Thrown for motions that no row of B resists and no load drives.
  class UnheldMotions : public UndeterminedPosition
  {
  public:
    UnheldMotions(const std::string &problem, const std::string &remedy, const std::vector<RigidMotion> &unheld)
      : UndeterminedPosition(problem, remedy)
      , motions(unheld)
    {}

    std::vector<RigidMotion> motions; // orthonormal
  };

  /// Thrown for motions that no row of B resists, along which the loads push.
  class DrivenMotions : public NoEquilibrium
  {
  public:
    DrivenMotions(const std::string              &problem,
                  const std::string              &remedy,
                  const std::vector<RigidMotion> &unheld,
                  const double                    work_)
      : NoEquilibrium(problem, remedy)
      , motions(unheld)
      , work(work_)
    {}

    std::vector<RigidMotion> motions; // orthonormal
    double                   work;    // of the loads, as in RigidMotion, along the motion where it is largest
  };

  /// Jumps of the rows of B under rigid motions of whole bodies (gluing rows excepted: both sides move with their
  /// body).
  class BodyMotions
  {
  public:
    /// @param subdomains must outlive this. @param names of all bodies. Collective.
    BodyMotions(const std::vector<std::unique_ptr<SubdomainSystem>> &subdomains,
                const Constraints                                   &constraints,
                const std::vector<std::string>                      &names,
                const MPI_Comm                                       comm);

    /// Names of the bodies.
    const std::vector<std::string> &names() const
    {
      return names_of_bodies;
    }

    /// Motions that no active row of B resists. Collective.
    /// @param active rows (owned by this rank) that take part; empty: all.
    /// @param resistance below which a motion counts as free: squared jumps of the rows under a unit motion, over the
    ///        largest of all motions. Rounding by default.
    /// @param turns rows treated as turned, active or not.
    /// @param rigid further rows, each of which resists any motion that moves it more than all the others together.
    std::vector<RigidMotion> free(const std::vector<bool>     &active,
                                  const double                 resistance = rounding_of_resistance,
                                  const std::vector<qp::Turn> &turns      = {},
                                  const std::vector<bool>     &rigid      = {}) const;

    static constexpr double rounding_of_resistance = 1e-12;

    /// Loads along the motions of all bodies [N]; 0 where the loads cancel to rounding. Collective.
    Eigen::VectorXd loads() const;

    /// e = R'f, the loads along the rigid motions of this rank's subdomains in turn [N]. Of a body whose loads balance
    /// each other, they sum to 0 without rounding, with which nothing that does not hold the body could be in
    /// equilibrium. Collective.
    Eigen::VectorXd loads_of_subdomains() const;

    /// Jumps B u of all rows that this rank owns (0 for gluing) under motions; rows x motions.
    Eigen::SparseMatrix<double, Eigen::RowMajor> jumps(const std::vector<RigidMotion> &motions) const;

    /// Displacements of subdomain p of this rank under a motion, all unknowns.
    Eigen::VectorXd displacements(const unsigned int p, const Eigen::VectorXd &amplitudes) const;

    /// Size of the largest body [mm].
    double largest_length() const
    {
      double result = 0;
      for (const BodyFrame &frame : frames)
        result = std::max(result, frame.length);
      return result;
    }

    /// Whether the bodies are solids, in space.
    bool are_solids() const
    {
      return is_solid(motions_of_body);
    }

  private:
    struct Share
    {
      unsigned int    row; // owned
      unsigned int    body;
      Eigen::VectorXd values; // of its motions
    };

    std::vector<Share>           turned(const std::vector<qp::Turn> &turns) const;
    std::vector<Eigen::VectorXd> unresisted(const std::vector<bool>  &active,
                                            const double              resistance,
                                            const std::vector<bool>  &rigid,
                                            const std::vector<Share> &of_rows) const;
    Eigen::SparseMatrix<double> resistance_of(const std::vector<bool> &active, const std::vector<Share> &of_rows) const;

    const std::vector<std::unique_ptr<SubdomainSystem>> &subdomains;
    std::vector<std::string>                             names_of_bodies;
    MPI_Comm                                             comm;
    unsigned int                                         n_owned_rows;
    unsigned int                                         motions_of_body; // 3 in the plane, 6 in space, 1 of revolution
    unsigned int                                         n_motions;       // of all bodies
    std::vector<BodyFrame>                               frames;
    std::vector<Share>                                   shares; // sorted by row
  };

  /// The motion of whole bodies (mean over the subdomains) from amplitudes of the rigid motions of this rank's
  /// subdomains. Collective.
  RigidMotion body_motion(const std::vector<std::unique_ptr<SubdomainSystem>> &subdomains,
                          const Eigen::VectorXd                               &amplitudes,
                          const unsigned int                                   n_bodies,
                          const MPI_Comm                                       comm);

  /// Names the motions of all bodies that move noticeably: "body box: translation along (1, 0)", "body a: rotation about (0,
  /// 5)", "body pin: translation along the axis".
  std::string describe(const RigidMotion &motion, const std::vector<std::string> &body_names);

  /// The same motions in reduced echelon form: each moves a component that none of the others moves.
  std::vector<RigidMotion> disentangled(const std::vector<RigidMotion> &motions);

  /// Among the combinations of free motions, the one along which the loads push or, if there is none, the one that
  /// moves the fewest components (translations before rotations). @param motions orthonormal, at least one.
  RigidMotion plainest(const std::vector<RigidMotion> &motions);

  /// @throws DrivenMotions naming the plainest of the motions if the loads push along it, otherwise UnheldMotions; does
  /// not throw if there are no motions.
  void require_support(const std::vector<RigidMotion> &motions, const std::vector<std::string> &body_names);
} // namespace slipstick::tfeti
