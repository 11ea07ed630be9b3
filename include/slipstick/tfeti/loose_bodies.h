// Loose bodies, which the currently free rows do not hold: rows that hold them, and whether friction can bear the
// loads.
#pragma once

#include <slipstick/tfeti/body_equilibrium.h>

#include <optional>

namespace slipstick::tfeti
{
  /// The motion of bodies that friction at the current bounds resists least.
  struct Overload
  {
    RigidMotion motion;
    double      held = 0; // part of the load along the motion that friction can bear; below 1: no equilibrium
    double      load = 0; // along the motion, whose amplitudes have unit length [N]
  };

  /// Chooses rows that hold the loose bodies. Rows are owned ones throughout; members are collective.
  class LooseBodies
  {
  public:
    /// The arguments are kept by reference. The loads are those of the subdomains. Collective.
    LooseBodies(const BodyMotions &motions_, const Constraints &rows_, const MPI_Comm comm_);

    /// Reads the current loads of the subdomains.
    void update_loads();

    /// The free rows and as many of the others as are needed to hold the bodies that the free rows leave loose. Bodies
    /// driven by loads move until contact stops them; otherwise rows with the smallest gaps [of any unit] are
    /// preferred. Returns the free rows alone if no body is loose or no rows can hold the loose ones.
    /// @param include_weakly_held also hold bodies that the free rows hold only weakly. @param turns rows treated as turned.
    std::vector<bool> hold(const std::vector<bool>     &free,
                           const std::vector<double>   &gaps,
                           const bool                   include_weakly_held,
                           const std::vector<qp::Turn> &turns = {}) const;

    /// Adds as many candidates to the free rows as are needed to hold the loose motions: those whose shares, times
    /// their scale, are largest. @return whether the loose motions are held.
    bool hold_by(const std::vector<RigidMotion> &loose,
                 const std::vector<bool>        &is_candidate,
                 const std::vector<double>      &scale,
                 std::vector<bool>              &free,
                 const std::vector<qp::Turn>    &turns = {}) const;

    /// Whether there are bodies held by contact alone whose motion is used to predict the active set. Only in the
    /// plane: in space the prediction is better without it (doc/decisions/0089).
    bool predict_active_sets() const;

    /// moved -= stiffness * (jumps of the motion of bodies held by contact alone), such that the forces `moved`,
    /// clipped to their bounds, balance the loads of these bodies, up to the part `tolerated` of all forces.
    void balance(const std::vector<double>                  &stiffness,
                 const qp::AdmissibleSet<DistributedVector> &bounds,
                 const double                                tolerated,
                 std::vector<double>                        &moved) const;

    /// @param free closed rows: gluing, supports, closed contact.
    /// @param capacity of a row with two bounds: the bound [N]; negative: the row bears no force; infinity: a row with
    /// one bound.
    /// @param below motions are ignored if friction bears at least this part of the load along them.
    /// @return the motion; nothing if there is none, or if so many bodies are loose that the search would take longer
    /// than the solve.
    std::optional<Overload> overload(const std::vector<bool>   &free,
                                     const std::vector<double> &capacity,
                                     const double               below = 1) const;

  private:
    // Moves loose bodies along their loads until a gap closes, then along the motions that are still possible, and so
    // on. The normal rows that stop the bodies become free. @return whether there are any.
    bool stop_driven(const std::vector<RigidMotion> &loose,
                     const std::vector<double>      &gaps,
                     std::vector<bool>              &free) const;

    const BodyMotions &motions;
    const Constraints &rows;
    MPI_Comm           comm;
    BodyEquilibrium    held_by_contact;
  };
} // namespace slipstick::tfeti
