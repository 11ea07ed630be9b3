// Bodies that the rows which hold at present leave free to move: what holds them, and whether friction can.
#pragma once

#include <slipstick/tfeti/body_equilibrium.h>

#include <optional>

namespace slipstick::tfeti
{
  /// The motion of bodies that friction at the current bounds resists least.
  struct Overload
  {
    RigidMotion motion;
    double      held = 0; // of the load along it friction bears this part: no equilibrium below 1
    double      load = 0; // along the motion, of unit length [N]
  };

  /// Which rows hold the bodies that others leave loose. Rows are owned ones throughout; members are collective.
  class LooseBodies
  {
  public:
    /// The arguments are referred to. The loads are those of the subdomains. Collective.
    LooseBodies(const BodyMotions &motions_, const Constraints &rows_, const MPI_Comm comm_);

    /// Takes over the present loads of the subdomains.
    void update_loads();

    /// The free rows and as many of the others as are needed to hold the bodies that the free rows leave loose. Bodies that
    /// the loads drive move until contact stops them; else the smallest gaps [of any unit] are preferred. Only the free rows
    /// if nothing is loose, or nothing can hold it.
    /// @param well bodies that free rows hardly hold are held, too. @param turns rows that count as turned.
    std::vector<bool> hold(const std::vector<bool>     &free,
                           const std::vector<double>   &gaps,
                           const bool                   well,
                           const std::vector<qp::Turn> &turns = {}) const;

    /// Adds as many candidates to the free rows as are needed to hold the loose motions: those whose shares, times
    /// their scale, are largest. @return whether they hold them.
    bool hold_by(const std::vector<RigidMotion> &loose,
                 const std::vector<bool>        &is_candidate,
                 const std::vector<double>      &scale,
                 std::vector<bool>              &free,
                 const std::vector<qp::Turn>    &turns = {}) const;

    /// Are there bodies held by contact alone, whose motion tells which points touch? In the plane: in space sets are told
    /// better without (doc/decisions/0089).
    bool tell_sets() const;

    /// moved -= stiffness times the jumps of the motion of bodies held by contact alone, after which the forces
    /// `moved`, clipped to their bounds, balance the loads of these bodies, up to the part `tolerated` of all forces.
    void balance(const std::vector<double>                  &stiffness,
                 const qp::AdmissibleSet<DistributedVector> &bounds,
                 const double                                tolerated,
                 std::vector<double>                        &moved) const;

    /// @param free rows that hold: gluing, supports, closed contact. @param capacity the bound of a row between two
    ///        bounds [N]; negative: the row bears nothing; infinity: a row with one bound. @param below motions of which
    ///        friction bears this part or more do not count. None where so many bodies are loose that the search would take
    ///        longer than the solve.
    std::optional<Overload> overload(const std::vector<bool>   &free,
                                     const std::vector<double> &capacity,
                                     const double               below = 1) const;

  private:
    // Loose bodies move as the loads drive them, first until a gap closes, then along what is still open: the normal rows that stop
    // them become free. @return whether there are any.
    bool stop_driven(const std::vector<RigidMotion> &loose,
                     const std::vector<double>      &gaps,
                     std::vector<bool>              &free) const;

    const BodyMotions &motions;
    const Constraints &rows;
    MPI_Comm           comm;
    BodyEquilibrium    held_by_contact; // bodies that nothing else holds
  };
} // namespace slipstick::tfeti
