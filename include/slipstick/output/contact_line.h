// Contact along the slave boundaries: contact.csv for tables and plots, contact_NNN.vtp for ParaView. Signs: see
// contact/result.h.
#pragma once

#include <slipstick/contact/result.h>
#include <slipstick/output/directory.h>

#include <array>
#include <cstdint>
#include <string>
#include <vector>

namespace slipstick::output
{
  /// Names for output, indexed by ContactNode::pair.
  struct ContactNames
  {
    std::vector<std::string> pairs;
    std::vector<std::string> slave_bodies;
    unsigned int             dimension = 2;
  };

  /// All contact nodes after one load step.
  struct ContactStep
  {
    unsigned int                      step = 0;
    std::vector<contact::ContactNode> nodes;

    /// In space: faces between nodes, as indices into `nodes`, which are then in output order.
    std::vector<std::vector<std::int64_t>> faces = {};
  };

  /// Writes contact.csv from rank 0, whose arguments are used: one row per node, steps in the given order, within a
  /// step by pair and arc length; in space also z, normal, area and the vectors of tangential traction and slip.
  /// Collective.
  void write_contact_csv(const OutputDirectory          &directory,
                         const ContactNames             &names,
                         const std::vector<ContactStep> &steps);

  /// Writes contact_NNN.vtp (NNN: the step) from rank 0, whose arguments are used: one line per pair along the arc
  /// length (a vertex for a pair with one node), in space the faces and a vertex for every other node; the node values
  /// as point data, status 0 open, 1 stick, 2 slip. Collective.
  /// @param displacement of the nodes, in their order in the step [mm]; empty: unknown.
  void write_contact_vtp(const OutputDirectory                    &directory,
                         const ContactStep                        &step,
                         const unsigned int                        dim          = 2,
                         const std::vector<std::array<double, 3>> &displacement = {});

  /// Writes contact.pvd, the collection of the files contact_NNN.vtp, with the load factor of each step as its time.
  /// Collective.
  void write_contact_pvd(const OutputDirectory &directory, const std::vector<double> &load_factors);
} // namespace slipstick::output
