// Contact results, by node and by pair.
//
// Sign conventions: normal = outward normal of the slave body; tangent = normal turned by +90 degrees (2D); in space
// there are two orthogonal tangents, and tangential traction and slip are given as magnitudes in addition to their
// vectors. Positive pressure is compression. Gap >= 0 open, < 0 penetrating, in the deformed configuration
// (linearised). Slip is the tangential displacement of the slave relative to the other side. Traction acts on the slave
// body.
#pragma once

#include <slipstick/base/resultant.h>

#include <array>
#include <string>
#include <vector>

namespace slipstick::contact
{
  enum class ContactStatus
  {
    open,
    stick,
    slip
  };

  /// "open", "stick", "slip"
  std::string to_string(const ContactStatus status);

  /// One slave node of a contact pair, computed from the recovered displacement. With a Tresca bound that acts on the
  /// whole declared boundary, a node that is not closed also slips if it reaches the bound; its status is then slip.
  /// Nodes of bonded pairs are closed and stick; their pressure may be negative, their slip bound is infinite.
  struct ContactNode
  {
    unsigned int          pair = 0;            // index into Scene::contacts
    std::array<double, 3> position{{0, 0, 0}}; // reference configuration [mm]
    std::array<double, 3> acts_at{{0, 0, 0}};  // point of action of the force on the slave body: mean of nodes near
                                               // the position [mm]
    std::array<double, 3> normal{{0, 0, 0}};
    double                arc_length          = 0; // along the slave boundary from its first node [mm]
    double                area                = 0; // reference area of tractions, see tfeti::ContactPoint [mm^2]
    double                length              = 0; // tributary length [mm]; in space area [mm^2]
    double                gap                 = 0; // [mm]
    double                initial_gap         = 0; // before loading [mm]
    double                pressure            = 0; // [MPa]
    double                tangential_traction = 0; // [MPa]
    double                slip                = 0; // of the load step [mm]
    std::array<double, 3> traction{{0, 0, 0}};     // in space: the tangential one [MPa] ...
    std::array<double, 3> slip_vector{{0, 0, 0}};  // ... and the slip [mm]
    double                total_slip = 0;          // of all load steps so far [mm]
    ContactStatus         status     = ContactStatus::open; // see is_closed
    bool                  is_closed  = false;               // in contact with the other side
    double                slip_bound = 0;                   // [MPa], from the law: Tresca bound or mu times pressure
    std::array<double, 3> moment_mismatch{{0, 0, 0}};       // of the forces on the two sides [N mm], see PairResult

    /// For sending between ranks (Boost serialization, through deal.II's MPI utilities).
    template <class Archive>
    void serialize(Archive &archive, const unsigned int /*version*/)
    {
      archive &pair &position &acts_at &normal &arc_length &area &length &gap &initial_gap &pressure
        &tangential_traction &slip &traction &slip_vector &total_slip &status &is_closed &slip_bound &moment_mismatch;
    }
  };

  /// Norms or errors of the pressures and the tangential tractions of a pair.
  struct PairTractions
  {
    double pressure = 0, tangential = 0;
  };

  struct PairResult
  {
    std::string           pair;
    Resultant             on_slave;                   // of the tractions, at the slave nodes
    double                normal_force     = 0;       // sum of pressure times area [N]
    double                tangential_force = 0;       // [N]
    std::array<double, 3> moment_mismatch{{0, 0, 0}}; // sum of the moments on both sides [N mm]: rounding, except for
                                                      // bodies of revolution; in the plane about z
    double       max_pressure    = 0;                 // [MPa]
    double       contact_length  = 0;                 // of the nodes that are not open [mm]; in space their area [mm^2]
    unsigned int contact_nodes   = 0;                 // closed
    unsigned int open_nodes      = 0;                 // not closed
    unsigned int stick_nodes     = 0;                 // closed and not slipping
    unsigned int open_slip_nodes = 0;                 // slipping, but not closed
    unsigned int slip_nodes      = 0; // slip bound reached, see ContactNode on nodes that are not closed

    PairTractions norm;            // L2 norms of the tractions [N/mm]
    PairTractions algebraic_error; // relative, see TractionErrors
  };
} // namespace slipstick::contact
