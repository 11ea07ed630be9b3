// Checks of the solution, computed from the recovered displacement alone, and the contact nodes.
#pragma once

#include <slipstick/contact/contact_nodes.h>
#include <slipstick/contact/places.h>
#include <slipstick/contact/slip_law.h>
#include <slipstick/contact/traction_error.h>
#include <slipstick/tfeti/dual_problem.h>

namespace slipstick::contact
{
  /// All values are relative: lengths to the largest displacement, contact forces to the largest nodal contact force,
  /// works and the energy norm to twice the strain energy, forces and moments of a body to the sum of the force
  /// magnitudes on it; where these references are smaller than the rounding level of gaps and displacements, that level
  /// is used. Gaps and slips come from u; contact forces are the multipliers, verified by K u - f + B'x = 0 at every
  /// node.
  struct Checks
  {
    double interface_jump    = 0; // largest |u_a - u_b| of glued copies and |u - prescribed|
    double penetration       = 0; // largest negative gap
    double complementarity   = 0; // sum of |pressure force * gap| and of |slip bound| |slip| - friction work
    double tension           = 0; // largest tensile contact force
    double friction_bound    = 0; // largest excess of the tangential force over the slip bound
    double nodal_equilibrium = 0; // largest K u - f + B'x, over the largest load, contact force or reaction of a node
    double force_balance     = 0; // worst body: loads + supports + contact
    double moment_balance    = 0;
    double algebraic_error   = 0; // upper bound in the energy norm: root of error_energy over u'K u
    double body_error        = 0; // worst body: the same over its own u'K u; at least algebraic_error
    double error_energy      = 0; // tfeti::jump_energies of all violated jumps [N mm]
    double max_displacement  = 0; // magnitude [mm]
    double energy            = 0; // u'K u, twice the strain energy [N mm]
    double largest_force     = 0; // of a contact node [N]
    double largest_traction  = 0; // L2 norm over a pair [sqrt(N MPa)]

    std::vector<double>        energies;        // u'K u of every body [N mm]
    std::vector<PairTractions> traction_errors; // of the forces that would close all violated jumps, see TractionErrors

    /// One of the relative checks.
    struct Entry
    {
      const char *name;
      double      value;
      bool        is_balance; // a balance of forces, which holds to rounding whatever the tolerance of the solver
      Place       place;
    };
    static constexpr unsigned int n_entries = 9;

    std::array<Place, n_entries> places; // of the largest values, in the order of entries()

    /// The relative checks with their names and places.
    std::array<Entry, n_entries> entries() const;

    /// The worst check; NaN counts as worse than any number.
    Entry worst_entry() const;

    /// The largest of the relative errors of pressures and tangential tractions of all pairs.
    double largest_traction_error() const;

    /// Name and value of the worst check.
    std::pair<std::string, double> worst() const;
  };

  /// The largest values of the previous load steps, the references below which values of a later step are negligible.
  struct History
  {
    double              displacement = 0;  // magnitude [mm]
    double              force        = 0;  // of a contact node [N]
    double              traction     = 0;  // L2 norm over a pair [sqrt(N MPa)]
    std::vector<double> energies     = {}; // u'K u of every body [N mm]; empty before the first step

    /// Updates the values after one more step.
    void add(const Checks &step);
  };

  struct CheckedContact
  {
    Checks                                    checks;
    std::vector<ContactNode>                  nodes;       // whose rows this rank owns
    std::vector<std::array<std::uint64_t, 2>> keys;        // mesh identifiers of these nodes
    std::vector<std::array<double, 3>>        held_forces; // on the HeldContacts::points of this rank [N]
  };

  /// @param u displacements of this rank's subdomains [mm].
  /// @param multipliers [N], in equilibrium with u, as returned by tfeti::recover.
  /// @param slip_bound of every owned row [N].
  /// @param history of the previous load steps.
  /// @param initial_strain_energies by body: this rank's contribution of initial strains that is added to u'K u to give
  /// twice the strain energy [N mm]; empty: none.
  /// @param free owned rows whose multiplier is strictly inside its bounds; this distinguishes closed from open and
  /// stick from slip.
  /// Collective.
  CheckedContact check(const tfeti::DualProblem           &dual,
                       const SlipLaw                      &law,
                       const tfeti::DistributedVector     &multipliers,
                       const std::vector<Eigen::VectorXd> &u,
                       const std::vector<double>          &slip_bound,
                       const std::vector<bool>            &free,
                       const unsigned int                  n_bodies,
                       const History                      &history                 = {},
                       const std::vector<double>          &initial_strain_energies = {});
} // namespace slipstick::contact
