// Checks of the answer from the recovered displacement alone, and the contact nodes computed from it.
#pragma once

#include <slipstick/contact/contact_nodes.h>
#include <slipstick/contact/places.h>
#include <slipstick/tfeti/dual_problem.h>

namespace slipstick::contact
{
  /// All relative: lengths to the largest displacement, contact forces to the largest nodal contact force, works and
  /// the energy norm to twice the strain energy, forces and moments of a body to the sum of the force magnitudes on it
  /// (to what rounding leaves of gaps and displacements, where these are smaller). Gaps and slips come from u; contact
  /// forces are the multipliers, which K u - f + B'x = 0 at every node confirms.
  struct Checks
  {
    double interface_jump    = 0; // largest |u_a - u_b| of glued copies and |u - prescribed|
    double penetration       = 0; // largest negative gap
    double complementarity   = 0; // sum of |pressure force * gap| and of |slip bound| |slip| - friction work
    double tension           = 0; // largest contact force that pulls
    double friction_bound    = 0; // largest excess of the tangential force over the slip bound
    double nodal_equilibrium = 0; // largest K u - f + B'x, over the largest load, contact force or reaction of a node
    double force_balance     = 0; // worst body: loads + supports + contact
    double moment_balance    = 0;
    double algebraic_error   = 0; // energy norm, from above: root of error_energy over u'K u
    double body_error        = 0; // worst body: the same over u'K u of its own, or algebraic_error
    double error_energy      = 0; // tfeti::jump_energies of all that u violates [N mm]
    double max_displacement  = 0; // magnitude [mm]
    double energy            = 0; // u'K u, twice the strain energy [N mm]
    double largest_force     = 0; // of a contact node [N]

    std::vector<double> energies; // u'K u of every body [N mm]

    /// One of the relative checks.
    struct Entry
    {
      const char *name;
      double      value;
      bool        is_balance; // of forces: exact to rounding, whatever the tolerance of the solver
      Place       place;
    };
    static constexpr unsigned int n_entries = 9;

    std::array<Place, n_entries> places; // of the largest values, in the order of entries()

    /// The relative checks with their names and places.
    std::array<Entry, n_entries> entries() const;

    /// The worst of them; a value that is not a number counts as worse than any other.
    Entry worst_entry() const;

    /// Its name and value.
    std::pair<std::string, double> worst() const;
  };

  /// The largest values of the previous load steps; values at the level of their rounding count as zero.
  struct History
  {
    double              displacement = 0;  // magnitude [mm]
    double              force        = 0;  // of a contact node [N]
    std::vector<double> energies     = {}; // u'K u of every body [N mm]; none before the first step

    /// Updates the values after one more step.
    void add(const Checks &step);
  };

  struct CheckedContact
  {
    Checks                                    checks;
    std::vector<ContactNode>                  nodes;       // whose rows this rank owns
    std::vector<std::array<std::uint64_t, 2>> keys;        // the mesh's names of these nodes
    std::vector<std::array<double, 3>>        held_forces; // on the HeldContacts::points of this rank [N]
  };

  /// @param u displacements of this rank's subdomains [mm].
  /// @param multipliers [N], balanced with u as tfeti::recover returns them.
  /// @param slip_bound of every owned row [N].
  /// @param energies_beside of every body, what initial strains add to u'K u for it to be twice its strain energy [N mm]; of
  /// this rank; empty: none.
  /// @param free owned rows whose multiplier is strictly inside its bounds: tells open from closed, stick from slip.
  /// Collective.
  CheckedContact check(const tfeti::DualProblem           &dual,
                       const tfeti::DistributedVector     &multipliers,
                       const std::vector<Eigen::VectorXd> &u,
                       const std::vector<double>          &slip_bound,
                       const std::vector<bool>            &free,
                       const unsigned int                  n_bodies,
                       const History                      &before          = {},
                       const std::vector<double>          &energies_beside = {});
} // namespace slipstick::contact
