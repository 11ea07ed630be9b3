// The rows of B: they glue the torn subdomains together, fix them and prevent penetration.
//
// Sign conventions of contact rows: see contact/result.h. A row reads b u = c (equality) or b u <= c (normal).
#pragma once

#include <slipstick/qp/node_set.h>

#include <deal.II/base/partitioner.h>
#include <deal.II/lac/la_parallel_vector.h>

#include <array>
#include <memory>
#include <optional>
#include <vector>

namespace slipstick::tfeti
{
  /// Dual vectors [N], and vectors over interface unknowns. Entries owned by this rank, with the ghosts of its
  /// partitioner where there are any.
  using DistributedVector = dealii::LinearAlgebra::distributed::Vector<double>;
  using Partitioner       = std::shared_ptr<const dealii::Utilities::MPI::Partitioner>;

  enum class RowKind : unsigned char
  {
    tangential, // friction: multiplier between -slip bound and +slip bound
    normal,     // contact: multiplier >= 0, b u = closing of the gap, c = gap [mm]
    gluing,     // equality of two copies of a node
    bonded,     // equality across a bonded pair; counted as gluing
    prescribed  // prescribed displacement [mm], elastic foundation (with compliance)
  };

  /// Whether multipliers of this kind are unbounded.
  constexpr bool is_equality(const RowKind kind)
  {
    return kind != RowKind::tangential && kind != RowKind::normal;
  }

  constexpr unsigned int invalid_row = static_cast<unsigned int>(-1);

  /// A potential contact node. One rank owns all of its rows.
  struct ContactPoint
  {
    unsigned int          pair = 0; // index into Scene::contacts
    std::array<double, 3> position{{0, 0, 0}};
    std::array<double, 3> normal{{0, 0, 0}};  // outward normal of the slave body
    bool                  has_master = false; // true: another body; false: an obstacle
    unsigned int          slave_body = 0, master_body = 0;
    std::array<double, 3> slave_position{
      {0, 0, 0}}; // where the force acts: mean of the slave nodes, or half the gap on
    std::array<double, 3> master_position{{0, 0, 0}}; // mean of the master nodes
    bool                  rotates = false; // its rows contain the rotations of both sides across the gap, so that the
                                           // forces on both sides have no moment
    double gap           = 0;              // reference configuration [mm]
    bool   is_measured   = false;          // whether the gap follows from positions of nodes alone
    double area          = 0;              // tributary of `pair`: length times thickness, or of revolution [mm^2]
    double length        = 0;              // tributary length [mm]
    double traction_area = 0;              // reference area of tractions: `area`, but at least half of the
                                           // node's full tributary area: the force on a sliver over the
                                           // area of that sliver is meaningless [mm^2]
    double                               traction_length = 0; // reference length of tractions, by the same rule [mm]
    std::array<std::uint64_t, 2>         key{{0, 0}};         // identifies the node in the mesh
    unsigned int                         normal_row     = invalid_row; // owned rows; invalid if a support replaces it
    unsigned int                         tangential_row = invalid_row;
    unsigned int                         second_row     = invalid_row; // in space: along the other tangent
    std::array<std::array<double, 3>, 2> tangents{};                   // in space
    bool   is_held_across = false;          // its law has friction, but supports let neither side slip
    double share = 1, tangential_share = 1; // of its rows' forces that belong to `pair`; the rest to shared points

    bool is_in_space() const
    {
      return tangents[0] != std::array<double, 3>{{0, 0, 0}};
    }
  };

  /// The part that belongs to another pair of a point where two pairs meet at the same nodes.
  struct SharedPoint
  {
    ContactPoint               point;             // as the carrier's, but for pair, area, length and shares
    unsigned int               carrier   = 0;     // index into the contact points ...
    bool                       is_bonded = false; // ... or the bonded points
    std::optional<qp::NodeSet> law;               // of a contact that shares the force of a bond [N]
  };

  /// An external constraint of a node in one direction: support, foundation or bond to an obstacle.
  struct Reaction
  {
    unsigned int          row = invalid_row; // owned; the force on the node is -multiplier times direction
    std::array<double, 3> direction{{0, 0, 0}};
    std::array<double, 3> position{{0, 0, 0}};
    std::vector<unsigned int>
      holders; // equal shares: numbers of supports, followed by foundations, contact pairs, the axis
  };

  /// B, c and the contact nodes, distributed. Every row has one owner; it is a ghost on the other ranks whose
  /// subdomains it touches. Interface unknowns are the displacements of nodes touched by rows, one for all copies of a
  /// node.
  struct Constraints
  {
    struct Entry
    {
      unsigned int row;   // local number in `rows`, ghosts behind the owned ones
      unsigned int dof;   // of the subdomain
      double       value; // coefficient of B
    };
    struct InterfaceEntry
    {
      unsigned int dof;           // of the subdomain
      unsigned int interface_dof; // local number in `interface_dofs`, ghosts behind the owned ones
    };
    struct Counts
    {
      unsigned long long tangential = 0, normal = 0, gluing = 0, prescribed = 0, candidates = 0;
      unsigned long long total() const
      {
        return tangential + normal + gluing + prescribed;
      }
    };

    Partitioner                              rows;
    std::vector<std::vector<Entry>>          blocks;     // B_p of the subdomains of this rank, sorted by row
    std::vector<RowKind>                     kind;       // of the owned rows
    std::vector<double>                      c;          // of the owned rows [mm]
    std::vector<double>                      compliance; // of the owned rows: b u - compliance x = c [mm/N]; empty: 0
    std::vector<std::uint64_t>               label;      // of the owned rows; independent of the number of ranks
    std::vector<ContactPoint>                contact_points; // whose rows this rank owns
    std::vector<ContactPoint>                bonded_points;  // the same for bonded rows: normal and tangential
    std::vector<SharedPoint>                 shared_points;  // of both
    std::vector<Reaction>                    reactions;      // whose rows this rank owns
    Partitioner                              interface_dofs;
    std::vector<std::vector<InterfaceEntry>> interface_blocks; // of the subdomains of this rank
    Counts                                   counts;           // over all ranks
  };

  /// Contact nodes whose gap is prescribed by supports (and bonds), so that they have no normal row; also nodes bonded
  /// to obstacles.
  struct HeldContacts
  {
    struct Point
    {
      ContactPoint              contact; // without rows
      bool                      is_bonded = false;
      unsigned int              holder    = 0; // of a bond: its own number, as in Reaction
      std::vector<unsigned int> reactions;     // at the node, indices into Constraints::reactions; obstacles only
      std::vector<unsigned int> holders;       // of all nodes of the row, numbered as in Reaction
      unsigned int              place    = invalid_row; // in Constraints::contact_points; invalid: no tangential row
      bool                      is_known = false;       // whether supports alone prescribe the gap
      double                    closing  = 0;           // if so: by how much they close it [mm]
    };

    std::vector<Point> points;
    Constraints        gaps; // rows, blocks, kind, c; one row per point: b u = closing of the gap, c = gap
  };
} // namespace slipstick::tfeti
